//! A tree of disks with eight children per node.
//!
//! Disks are sorted along a Morton curve (G. M. Morton, *A Computer Oriented Geodetic Data Base*, 1966), and
//! eight neighbors make a node, level by level. There are no pointers: the children of a node are the block
//! of its own number one level below. The eight of a block lie side by side, number by number.

use std::f64::consts::PI;

use glam::DVec3;

/// A flat disk that hides what is behind it from those whom it faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disk {
    pub(super) center: DVec3,
    /// Of length 1.
    pub(super) normal: DVec3,
    pub(super) area: f64,
}

/// What a receiver sees of all disks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// The sum of their form factors.
    pub(super) hidden: f64,
    /// The sum of the directions to them, by their form factors.
    pub(super) towards: DVec3,
}

impl std::ops::AddAssign for Seen {
    fn add_assign(&mut self, other: Self) {
        self.hidden += other.hidden;
        self.towards += other.towards;
    }
}

/// A node of the tree, or a disk.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// The mean of the disks' centers by area. It does not depend on the weights.
    center: DVec3,
    /// All centers of disks lie within this distance of the center.
    radius: f64,
    /// Σ w·a over the disks, with w their weights and a their areas.
    area: f64,
    /// Σ w·a·n, with n their normals.
    normal: DVec3,
    /// Σ w·a·n·nᵀ: xx, yy, zz, xy, yz, zx.
    square: [f64; 6],
}

const WIDTH: usize = 8;

/// Eight children of a node. Those that are missing have no area.
#[derive(Clone, Debug)]
struct Block {
    center: [[f64; WIDTH]; 3],
    radius: [f64; WIDTH],
    area: [f64; WIDTH],
    normal: [[f64; WIDTH]; 3],
    square: [[f64; WIDTH]; 6],
}

#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// The disks along the curve, and the index of each in the list that they came from.
    disks: Vec<(Disk, u32)>,
    /// The disks in the first level; each further level has an eighth of the blocks, the last one has one.
    levels: Vec<Vec<Block>>,
}

impl Tree {
    /// Every disk counts as it is.
    pub(super) fn over(disks: &[Disk]) -> Self {
        let curve = Curve::around(disks);
        let mut order: Vec<(u64, u32)> =
            disks.iter().zip(0..).map(|(disk, index)| (curve.place(disk.center), index)).collect();
        order.sort_unstable();
        let disks: Vec<(Disk, u32)> =
            order.into_iter().map(|(_, index)| (disks[index as usize], index)).collect();
        let mut tree = Self { levels: Vec::new(), disks };
        let count = tree.disks.len();
        tree.build(&vec![1.0; count]);
        tree
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.disks) + self.levels.iter().map(|level| size_of_val(&**level)).sum::<usize>()
    }

    /// Lets each disk count by its weight, in the order of the list that the tree was made from.
    pub(super) fn weigh(&mut self, weights: &[f64]) {
        self.build(weights);
    }

    fn build(&mut self, weights: &[f64]) {
        self.levels.clear();
        let leaf = |&(disk, index): &(Disk, u32)| Node::of(disk, weights[index as usize]);
        // By area alone, for the centers.
        let mut bulk: Vec<f64> = self.disks.iter().map(|(disk, _)| disk.area).collect();
        let mut nodes: Vec<Node> = self.disks.iter().map(leaf).collect();
        loop {
            self.levels.push(nodes.chunks(WIDTH).map(Block::of).collect());
            if nodes.len() <= WIDTH {
                break;
            }
            nodes = nodes
                .chunks(WIDTH)
                .zip(bulk.chunks(WIDTH))
                .map(|(nodes, bulk)| Node::around(nodes, bulk))
                .collect();
            bulk = bulk.chunks(WIDTH).map(|bulk| bulk.iter().sum()).collect();
        }
    }

    /// Adds up form factors over a point and normal; without a normal, shares of all directions.
    ///
    /// A node whose radius is at most `theta` of its distance counts as one disk. It holds centers only, so
    /// one whose centers are all below the horizon hides nothing. `stack` is a buffer.
    pub(super) fn sum(
        &self,
        p: DVec3,
        normal: Option<DVec3>,
        theta: f64,
        stack: &mut Vec<(usize, usize)>,
    ) -> Seen {
        let mut seen = Seen::default();
        stack.clear();
        stack.push((self.levels.len() - 1, 0));
        while let Some((level, number)) = stack.pop() {
            let Some(block) = self.levels[level].get(number) else { continue };
            let view = block.from(p, normal);
            // Without branches: which are above the horizon, and which of these are too near to count as one.
            let (mut counts, mut near) = ([0.0; WIDTH], [false; WIDTH]);
            for i in 0..WIDTH {
                let (radius, distance) = (block.radius[i], view.distance[i]);
                let above = (view.height[i] > -radius) & (block.area[i] > 0.0);
                let wide = (level > 0) & (radius > theta * distance);
                near[i] = above & wide;
                counts[i] = if above & !wide & (distance > 0.0) { 1.0 } else { 0.0 };
            }
            for lane in (0..WIDTH).filter(|&lane| near[lane]) {
                stack.push((level - 1, WIDTH * number + lane));
            }
            if counts != [0.0; WIDTH] {
                seen += block.hidden(&view, level > 0, &counts);
            }
        }
        seen
    }

    /// The same without a tree.
    #[cfg(test)]
    pub(super) fn plain_sum(&self, p: DVec3, normal: Option<DVec3>) -> Seen {
        let mut seen = Seen::default();
        for block in &self.levels[0] {
            let view = block.from(p, normal);
            let counts: [f64; WIDTH] =
                std::array::from_fn(
                    |i| if block.area[i] > 0.0 && view.distance[i] > 0.0 { 1.0 } else { 0.0 },
                );
            seen += block.hidden(&view, false, &counts);
        }
        seen
    }
}

impl Node {
    fn of(Disk { center, normal, area }: Disk, weight: f64) -> Self {
        let (area, DVec3 { x, y, z }) = (weight * area, normal);
        let square = [x * x, y * y, z * z, x * y, y * z, z * x].map(|product| area * product);
        Self { center, radius: 0.0, area, normal: area * normal, square }
    }

    fn around(nodes: &[Self], bulk: &[f64]) -> Self {
        let whole: f64 = bulk.iter().sum();
        let center: DVec3 = nodes.iter().zip(bulk).map(|(node, bulk)| (bulk / whole) * node.center).sum();
        let mut all = Self { center, ..Self::default() };
        for node in nodes {
            all.radius = all.radius.max(node.center.distance(center) + node.radius);
            all.area += node.area;
            all.normal += node.normal;
            for (sum, square) in all.square.iter_mut().zip(node.square) {
                *sum += square;
            }
        }
        all
    }
}

/// A block seen from a receiver.
struct View {
    /// To the centers.
    across: [[f64; WIDTH]; 3],
    distance: [f64; WIDTH],
    /// Above the horizon; without one, the distance.
    height: [f64; WIDTH],
    has_horizon: bool,
}

impl Block {
    fn of(nodes: &[Node]) -> Self {
        let lanes =
            |number: &dyn Fn(&Node) -> f64| std::array::from_fn(|lane| nodes.get(lane).map_or(0.0, number));
        Self {
            center: std::array::from_fn(|axis| lanes(&|node| node.center[axis])),
            radius: lanes(&|node| node.radius),
            area: lanes(&|node| node.area),
            normal: std::array::from_fn(|axis| lanes(&|node| node.normal[axis])),
            square: std::array::from_fn(|entry| lanes(&|node| node.square[entry])),
        }
    }

    fn from(&self, p: DVec3, normal: Option<DVec3>) -> View {
        let across: [[f64; WIDTH]; 3] =
            std::array::from_fn(|axis| self.center[axis].map(|center| center - p[axis]));
        let dot = |v: DVec3| -> [f64; WIDTH] {
            std::array::from_fn(|i| v.x * across[0][i] + v.y * across[1][i] + v.z * across[2][i])
        };
        let distance = std::array::from_fn(|i| {
            (across[0][i] * across[0][i] + across[1][i] * across[1][i] + across[2][i] * across[2][i]).sqrt()
        });
        View { height: normal.map_or(distance, dot), across, distance, has_horizon: normal.is_some() }
    }

    /// The sum of form factors of the disks, or of the disks of nodes taken as one, that count:
    /// A·cosE·cosR / (πr² + A), exact for a disk that faces the receiver straight on, and never above 1.
    ///
    /// A·cosE of many disks is the area of their fronts as the receiver sees it: half of Σ a·|cos| + Σ a·cos.
    /// The first sum is not known. By Cauchy and Schwarz it is at most √(Σ a · Σ a·cos²), which stands for
    /// it.
    ///
    /// All eight are worked out without branches, two or more by each instruction. `counts` is 1 for those
    /// that count, else 0.
    fn hidden(&self, view: &View, is_node: bool, counts: &[f64; WIDTH]) -> Seen {
        let nodes = if is_node { 1.0 } else { 0.0 };
        let (share, share_area) = if view.has_horizon { (1.0, 1.0) } else { (0.25, 0.5) };
        let [across_x, across_y, across_z] = &view.across;
        let [nx, ny, nz] = &self.normal;
        let [xx, yy, zz, xy, yz, zx] = &self.square;
        let (mut x, mut y, mut z, mut hidden) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for i in 0..WIDTH {
            let (distance, area) = (view.distance[i], self.area[i]);
            let per = 1.0 / distance;
            (x[i], y[i], z[i]) = (across_x[i] * per, across_y[i] * per, across_z[i] * per);
            let facing = -(x[i] * nx[i] + y[i] * ny[i] + z[i] * nz[i]);
            let square = x[i] * x[i] * xx[i]
                + y[i] * y[i] * yy[i]
                + z[i] * z[i] * zz[i]
                + 2.0 * (x[i] * y[i] * xy[i] + y[i] * z[i] * yz[i] + z[i] * x[i] * zx[i]);
            // A lone disk has no such second side.
            let both = nodes * (area * square.abs()).sqrt();
            let front = 0.5 * (larger(facing.abs(), both) + facing);
            let cosine = larger(view.height[i] * per, 0.0) * share;
            hidden[i] = front * cosine / (PI * distance * distance + share_area * area);
        }
        let mut seen = Seen::default();
        for i in (0..WIDTH).filter(|&i| counts[i] > 0.0) {
            seen.hidden += hidden[i];
            seen.towards += hidden[i] * DVec3::new(x[i], y[i], z[i]);
        }
        seen
    }
}

/// As `f64::max`, in one instruction: it need not tell what is not a number.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Morton curve through the box of some disks, 2²¹ cells along each axis.
struct Curve {
    low: DVec3,
    scale: DVec3,
}

impl Curve {
    fn around(disks: &[Disk]) -> Self {
        let low = disks.iter().fold(DVec3::INFINITY, |low, disk| low.min(disk.center));
        let high = disks.iter().fold(DVec3::NEG_INFINITY, |high, disk| high.max(disk.center));
        // Any order is right, and this one is fast. Casts of what is not a number give 0.
        Self { low, scale: DVec3::splat(f64::from((1 << 21) - 1)) / (high - low) }
    }

    fn place(&self, center: DVec3) -> u64 {
        let at = (center - self.low) * self.scale;
        spread(at.x as u64) | spread(at.y as u64) << 1 | spread(at.z as u64) << 2
    }
}

/// The 21 lowest bits of `x`, with two zeros before each.
fn spread(x: u64) -> u64 {
    let mut x = x & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
