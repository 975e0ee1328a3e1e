//! A model that moves, generated, and the positions of its vertices at a time: plain arrays and textbook
//! formulas, written without a look at the code that is tested.

/// A node below its parent.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) parent: Option<usize>,
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
    pub(super) scale: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    Translation,
    Rotation,
    Scale,
    Weights,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Step,
    Linear,
    Cubic,
}

/// Keys of a node: for each the tangent before it, its value, the tangent behind it.
#[derive(Clone, Debug)]
pub(super) struct Keys {
    pub(super) node: usize,
    pub(super) path: Path,
    pub(super) mode: Mode,
    pub(super) times: Vec<f32>,
    pub(super) keys: Vec<[Vec<f32>; 3]>,
}

/// A mesh with joints and morph targets. Node 0 carries it, and is the root.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) nodes: Vec<Node>,
    pub(super) clip: Vec<Keys>,
    /// Nodes; no skin if there are none.
    pub(super) joints: Vec<usize>,
    /// Column by column.
    pub(super) inverse_binds: Option<Vec<[f32; 16]>>,
    /// Of each vertex, each joint with its weight.
    pub(super) influences: Vec<Vec<(u32, f32)>>,
    pub(super) positions: Vec<[f32; 3]>,
    /// Displacements.
    pub(super) targets: Vec<Vec<[f32; 3]>>,
    pub(super) weights: Vec<f32>,
}

type Matrix = [[f64; 4]; 4]; // rows

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; 4]; 4];
    for row in 0..4 {
        for column in 0..4 {
            for k in 0..4 {
                c[row][column] += a[row][k] * b[k][column];
            }
        }
    }
    c
}

fn applied(m: &Matrix, p: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| m[row][0] * p[0] + m[row][1] * p[1] + m[row][2] * p[2] + m[row][3])
}

fn unit(q: &[f64]) -> [f64; 4] {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    [q[0] / length, q[1] / length, q[2] / length, q[3] / length]
}

/// The Hamilton product.
fn times(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a, b);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// Turns `a` towards `b` by the part `s` of the angle between them, about its axis.
fn turned(a: [f64; 4], b: [f64; 4], s: f64) -> [f64; 4] {
    let [x, y, z, w] = times(b, [-a[0], -a[1], -a[2], a[3]]);
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    let length = (x * x + y * y + z * z).sqrt();
    if length == 0.0 {
        return a;
    }
    let half = length.atan2(sign * w) * s;
    let axis = sign * half.sin() / length;
    times([x * axis, y * axis, z * axis, half.cos()], a)
}

fn matrix(t: [f64; 3], q: [f64; 4], s: [f64; 3]) -> Matrix {
    let [x, y, z, w] = unit(&q);
    let r = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let row = |i: usize| [r[i][0] * s[0], r[i][1] * s[1], r[i][2] * s[2], t[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

impl Keys {
    fn value(&self, time: f64) -> Vec<f64> {
        let wide = |list: &[f32]| list.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
        let last = self.times.len() - 1;
        if time <= f64::from(self.times[0]) {
            return wide(&self.keys[0][1]);
        }
        if time >= f64::from(self.times[last]) {
            return wide(&self.keys[last][1]);
        }
        let mut i = 0;
        while f64::from(self.times[i + 1]) <= time {
            i += 1;
        }
        let dt = f64::from(self.times[i + 1]) - f64::from(self.times[i]);
        let t = (time - f64::from(self.times[i])) / dt;
        let (v0, v1) = (wide(&self.keys[i][1]), wide(&self.keys[i + 1][1]));
        match self.mode {
            Mode::Step => v0,
            Mode::Linear if self.path == Path::Rotation => turned(unit(&v0), unit(&v1), t).to_vec(),
            Mode::Linear => (0..v0.len()).map(|k| v0[k] + t * (v1[k] - v0[k])).collect(),
            Mode::Cubic => {
                let (b, a) = (wide(&self.keys[i][2]), wide(&self.keys[i + 1][0]));
                let point = |k: usize| {
                    (2.0 * t.powi(3) - 3.0 * t.powi(2) + 1.0) * v0[k]
                        + dt * (t.powi(3) - 2.0 * t.powi(2) + t) * b[k]
                        + (-2.0 * t.powi(3) + 3.0 * t.powi(2)) * v1[k]
                        + dt * (t.powi(3) - t.powi(2)) * a[k]
                };
                (0..v0.len()).map(point).collect()
            }
        }
    }
}

impl Model {
    fn world(&self, node: usize, time: f64) -> Matrix {
        let Node { parent, mut translation, mut rotation, mut scale } = self.nodes[node].clone();
        for keys in self.clip.iter().filter(|keys| keys.node == node) {
            let value = keys.value(time);
            match keys.path {
                Path::Translation => translation.copy_from_slice(&value),
                Path::Rotation => rotation.copy_from_slice(&value),
                Path::Scale => scale.copy_from_slice(&value),
                Path::Weights => {}
            }
        }
        let own = matrix(translation, rotation, scale);
        parent.map_or(own, |parent| product(&self.world(parent, time), &own))
    }

    /// The world positions of the vertices, to the precision of `f64`.
    pub(super) fn posed(&self, time: f64) -> Vec<[f64; 3]> {
        let mut weights: Vec<f64> = self.weights.iter().map(|&w| f64::from(w)).collect();
        for keys in self.clip.iter().filter(|keys| keys.path == Path::Weights) {
            weights = keys.value(time);
        }
        let joint = |j: usize| {
            let world = self.world(self.joints[j], time);
            self.inverse_binds.as_ref().map_or(world, |all| {
                let inverse = std::array::from_fn(|row| {
                    std::array::from_fn(|column| f64::from(all[j][4 * column + row]))
                });
                product(&world, &inverse)
            })
        };
        let joints: Vec<Matrix> = (0..self.joints.len()).map(joint).collect();
        let own = self.world(0, time);
        let vertex = |v: usize| {
            let mut p = self.positions[v].map(f64::from);
            for (target, weight) in self.targets.iter().zip(&weights) {
                (0..3).for_each(|axis| p[axis] += weight * f64::from(target[v][axis]));
            }
            if joints.is_empty() {
                return applied(&own, p);
            }
            let sum: f64 = self.influences[v].iter().map(|&(_, weight)| f64::from(weight)).sum();
            let mut moved = [0.0; 3];
            for &(joint, weight) in &self.influences[v] {
                let by = applied(&joints[joint as usize], p);
                (0..3).for_each(|axis| moved[axis] += f64::from(weight) / sum * by[axis]);
            }
            moved
        };
        (0..self.positions.len()).map(vertex).collect()
    }

    /// The models of the tests, each after a kind of sample that any animation system must get right.
    pub(super) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for seed in 0..4 {
            let mut random = Random(0x9e37_79b9 + seed);
            let r = &mut random;
            all.push(Self::new("simple skin", r, 2, 4, 0, &[(Path::Rotation, Mode::Linear)]));
            let four = [Path::Translation, Path::Rotation, Path::Scale];
            all.push(Self::new("cubic splines", r, 3, 4, 0, &four.map(|path| (path, Mode::Cubic))));
            all.push(Self::new("steps", r, 3, 4, 0, &four.map(|path| (path, Mode::Step))));
            all.push(Self::new("lines", r, 3, 4, 0, &four.map(|path| (path, Mode::Linear))));
            all.push(Self::new("morph weights", r, 0, 0, 3, &[(Path::Weights, Mode::Linear)]));
            all.push(Self::new("morph spline", r, 0, 0, 2, &[(Path::Weights, Mode::Cubic)]));
            all.push(Self::new("eight weights", r, 9, 8, 0, &[(Path::Rotation, Mode::Linear)]));
            all.push(Self::new("nested joints", r, 12, 4, 0, &[(Path::Rotation, Mode::Cubic)]));
            let both = [(Path::Rotation, Mode::Linear), (Path::Weights, Mode::Linear)];
            all.push(Self::new("morphed skin", r, 4, 4, 2, &both));
            let rigid = [(Path::Rotation, Mode::Linear), (Path::Translation, Mode::Linear)];
            all.push(Self::new("rigid node", r, 0, 0, 0, &rigid));
            let mut mirrored = Self::new("mirrored node", r, 0, 0, 0, &rigid);
            mirrored.nodes[0].scale[1] = -1.5;
            all.push(mirrored);
            let mut mirrored = Self::new("mirrored joint", r, 3, 4, 0, &rigid);
            mirrored.nodes[1].scale = [-1.0, 1.0, 1.0];
            all.push(mirrored);
            let mut plain = Self::new("no inverse binds", r, 3, 4, 0, &rigid);
            plain.inverse_binds = None;
            all.push(plain);
        }
        all
    }

    /// `count` joints, each below the one before it or below the root; `per_vertex` of them move a vertex.
    fn new(
        name: &'static str,
        random: &mut Random,
        count: usize,
        per_vertex: usize,
        target_count: usize,
        moved: &[(Path, Mode)],
    ) -> Self {
        let mut nodes = Vec::new();
        for node in 0..=count {
            let parent = (node > 0).then(|| if node % 3 == 2 { 0 } else { node - 1 });
            nodes.push(Node {
                parent,
                translation: [(); 3].map(|()| random.fine(2.0)),
                rotation: unit(&random.four()),
                scale: [(); 3].map(|()| random.fine(0.5) + 1.0),
            });
        }
        // A closed box of 6 by 4 by 3 vertices would do as well: the positions are all that matters here.
        let vertices = 24;
        let positions = (0..vertices).map(|_| [(); 3].map(|()| random.fine(3.0) as f32)).collect();
        let target = |r: &mut Random| (0..vertices).map(|_| [(); 3].map(|()| r.fine(1.0) as f32)).collect();
        let targets: Vec<Vec<[f32; 3]>> = (0..target_count).map(|_| target(random)).collect();
        let weights = (0..target_count).map(|_| random.fine(1.0) as f32).collect();
        let joints: Vec<usize> = (1..=count).collect();
        let inverse = |r: &mut Random| {
            let m = matrix([(); 3].map(|()| r.fine(2.0)), r.four(), [1.0, 1.25, 0.75]);
            std::array::from_fn(|at| m[at % 4][at / 4] as f32)
        };
        let inverse_binds = (count > 0).then(|| (0..count).map(|_| inverse(random)).collect());
        let influence = |r: &mut Random| {
            let first = (r.next() as usize) % count.max(1);
            let joint = |k: usize| ((first + k) % count) as u32;
            // Their sum is not 1, as far as `f32` goes or farther.
            let mut list: Vec<(u32, f32)> =
                (0..per_vertex.min(count)).map(|k| (joint(k), r.fine(0.25) as f32 + 0.3)).collect();
            list.sort_unstable_by_key(|&(joint, _)| joint);
            list
        };
        let influences = (0..vertices).map(|_| influence(random)).collect();
        let mut clip = Vec::new();
        for &(path, mode) in moved {
            for node in (0..=count).filter(|node| path != Path::Weights || *node == 0) {
                clip.push(random.keys(node, path, mode, target_count));
            }
        }
        Self { name, nodes, clip, joints, inverse_binds, influences, positions, targets, weights }
    }

    /// Times between keys, at keys, and outside of them.
    pub(super) fn times() -> Vec<f64> {
        let mut times: Vec<f64> = (-4..30).map(|i| f64::from(i) * 0.11 + 0.003).collect();
        times.extend([0.25, 0.5, 1.0, 2.5, 1e6, -1e6]);
        times
    }
}

/// A linear congruential generator (Knuth).
pub(super) struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as u32
    }

    /// A multiple of 1/256 from −size to size, so that sums of few of them are exact in `f32`.
    fn fine(&mut self, size: f64) -> f64 {
        let steps = (size * 256.0) as i64;
        (i64::from(self.next()) % (2 * steps + 1) - steps) as f64 / 256.0
    }

    fn four(&mut self) -> [f64; 4] {
        let mut q = [(); 4].map(|()| self.fine(1.0));
        q[3] += 0.01;
        q
    }

    fn keys(&mut self, node: usize, path: Path, mode: Mode, targets: usize) -> Keys {
        let width = match path {
            Path::Rotation => 4,
            Path::Weights => targets,
            _ => 3,
        };
        let count = 2 + self.next() as usize % 4;
        let mut time = 0.0;
        let mut times = Vec::new();
        for _ in 0..count {
            time += self.fine(0.25) as f32 + 0.375;
            times.push(time);
        }
        let mut value = || -> Vec<f32> {
            match path {
                Path::Rotation => unit(&self.four()).map(|x| x as f32).to_vec(),
                Path::Scale => (0..3).map(|_| self.fine(0.5) as f32 + 1.0).collect(),
                _ => (0..width).map(|_| self.fine(2.0) as f32).collect(),
            }
        };
        let keys = (0..count).map(|_| [value(), value(), value()]).collect();
        Keys { node, path, mode, times, keys }
    }
}
