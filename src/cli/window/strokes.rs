//! Lines over a picture, in pieces that are seen or hidden.

use umbrage::geom::Light;
use umbrage::glam::DVec3;
use umbrage::mesh::Mesh;
use umbrage::shadow::Samples;
use umbrage::silhouette::Silhouette;
use umbrage::topology::Topology;
use umbrage::view::{Projected, Rays};

/// A piece of a line over a picture. Positions are from 0 at the upper left corner to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) ends: [[f32; 2]; 2],
    pub(super) color: [u8; 3],
    /// Whether a surface lies before it.
    pub(super) is_hidden: bool,
}

/// Color of silhouettes, and of the edges of volumes.
pub(super) const SILHOUETTE: [u8; 3] = [255, 128, 0];
pub(super) const VOLUME: [u8; 3] = [90, 110, 235];

/// The longest piece, in samples: where a line is hidden is as fine.
const PIECE: f64 = 8.0;
/// The most pieces of a line, and of all.
const PIECES: f64 = 64.0;
const STROKES: usize = 60_000;
/// The most edges of a volume that are drawn: more hide what is seen.
const EDGES: usize = 400;
/// How far an edge of a volume is drawn, in diagonals of the caster.
const FAR: f64 = 2.0;
/// What lies less than this behind a surface lies on it; in diagonals. Affects dimming only.
const SKIN: f64 = 1.0 / 256.0;

/// Lines over a picture of some samples.
pub(super) struct Canvas<'a> {
    samples: &'a Samples,
    rays: Rays,
    eye: DVec3,
    forward: DVec3,
    /// Samples in a row, and rows.
    size: [usize; 2],
    skin: f64,
    pub(super) strokes: Vec<Stroke>,
    pub(super) spots: Vec<Stroke>,
}

impl<'a> Canvas<'a> {
    /// `diagonal` is that of what casts.
    pub(super) fn new(samples: &'a Samples, diagonal: f64) -> Self {
        let projection = samples.projection();
        let n = samples.per_side() as usize;
        Self {
            samples,
            rays: Rays::new(projection, samples.size()),
            eye: DVec3::from(projection.eye.map(f64::from)),
            forward: DVec3::from(projection.forward.map(f64::from)),
            size: [samples.size().width() as usize * n, samples.size().height() as usize * n],
            skin: SKIN * diagonal,
            strokes: Vec::new(),
            spots: Vec::new(),
        }
    }

    /// A straight line in space.
    pub(super) fn line(&mut self, ends: [[f32; 3]; 2], color: [u8; 3]) {
        let [a, b] = ends.map(|end| DVec3::from(end.map(f64::from)));
        let n = f64::from(self.samples.per_side());
        // A line that passes the eye has no length in the picture: it is cut into the most pieces.
        let long = match [a, b].map(|end| self.project(end)) {
            [Some(a), Some(b)] => n * (a.x_px - b.x_px).hypot(a.y_px - b.y_px) / PIECE,
            _ => PIECES,
        };
        let pieces = long.clamp(1.0, PIECES).ceil();
        let at = |i: f64| a.lerp(b, i / pieces);
        for i in 0..pieces as usize {
            if self.strokes.len() == STROKES {
                return;
            }
            let i = i as f64;
            let ends = [at(i), at(i + 1.0)].map(|end| self.project(end));
            let ([Some(from), Some(to)], Some(middle)) = (ends, self.project(at(i + 0.5))) else { continue };
            if !self.is_near(&from) && !self.is_near(&to) {
                continue;
            }
            let is_hidden = self.hides(&middle);
            self.strokes.push(Stroke { ends: [self.part(&from), self.part(&to)], color, is_hidden });
        }
    }

    /// A spot, whatever lies before it.
    pub(super) fn spot(&mut self, at: [f32; 3], color: [u8; 3]) {
        if let Some(at) = self.rays.project(at)
            && self.is_near(&at)
        {
            let is_hidden = self.hides(&at);
            self.spots.push(Stroke { ends: [self.part(&at); 2], color, is_hidden });
        }
    }

    pub(super) fn silhouette(&mut self, mesh: &Mesh, topology: &Topology, silhouette: &Silhouette) {
        for edge in &silhouette.edges {
            let ends = topology.vertices(edge.edge).map(|vertex| mesh.positions()[vertex.index()]);
            self.line(ends, SILHOUETTE);
        }
    }

    /// The edges of a shadow volume that leave the vertices of a silhouette; of many, some.
    pub(super) fn volume(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        silhouette: &Silhouette,
        light: &Light,
        diagonal: f64,
    ) {
        let mut vertices: Vec<_> =
            silhouette.edges.iter().flat_map(|edge| topology.vertices(edge.edge)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let step = vertices.len().div_ceil(EDGES).max(1);
        let source = DVec3::from(light.xyz().map(f64::from));
        for vertex in vertices.into_iter().step_by(step) {
            let from = DVec3::from(mesh.positions()[vertex.index()].map(f64::from));
            let away = if light.is_directional() { -source } else { from - source };
            let to = from + FAR * diagonal * away.normalize_or_zero();
            self.line([from, to].map(|end| end.as_vec3().into()), VOLUME);
        }
    }

    fn project(&self, point: DVec3) -> Option<Projected> {
        self.rays.project(point.as_vec3().into())
    }

    /// Whether a position is in the picture, or beside it by less than its size.
    fn is_near(&self, at: &Projected) -> bool {
        let [x, y] = self.part(at);
        (-1.0..2.0).contains(&x) && (-1.0..2.0).contains(&y)
    }

    /// A position as parts of the width and the height.
    fn part(&self, at: &Projected) -> [f32; 2] {
        let size = self.samples.size();
        [at.x_px / f64::from(size.width()), at.y_px / f64::from(size.height())].map(|x| x as f32)
    }

    /// Whether a surface is nearer at the sample of a position and at all its neighbors: beneath a
    /// silhouette, half of the samples see what lies behind.
    fn hides(&self, at: &Projected) -> bool {
        let n = f64::from(self.samples.per_side());
        let [width, height] = self.size;
        let [x, y] = [at.x_px * n, at.y_px * n].map(|x| x as isize);
        let inside = |x: isize, side: usize| usize::try_from(x).ok().filter(|&x| x < side);
        (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| (x, y))).all(|(x, y)| {
            let (Some(x), Some(y)) = (inside(x, width), inside(y, height)) else { return false };
            self.samples.hits()[y * width + x].as_ref().is_some_and(|hit| {
                let depth = self.forward.dot(DVec3::from(hit.point.map(f64::from)) - self.eye);
                depth + self.skin < at.depth
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::caster::{Caster, CasterGroup};
    use umbrage::facing::CasterFaces;
    use umbrage::testing::shapes;
    use umbrage::view::{Camera, Size, Up};

    fn canvas<R>(per_side: u32, draw: impl FnOnce(&Caster, &mut Canvas<'_>) -> R) -> R {
        let caster = Caster::new(shapes::cube());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(80, 60).unwrap();
        let camera = Camera::look_at([0.0, 0.0, 6.0], [0.0; 3], 0.9, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, per_side).unwrap();
        draw(&caster, &mut Canvas::new(&samples, 3.5))
    }

    #[test]
    fn line_is_hidden_behind_the_cube_and_seen_before_and_beside_it() {
        for per_side in [1, 2] {
            canvas(per_side, |_, canvas| {
                canvas.line([[-2.0, 0.1, -2.0], [2.0, 0.1, -2.0]], [1; 3]);
                let hidden = canvas.strokes.iter().filter(|stroke| stroke.is_hidden).count();
                assert!(hidden > 1 && hidden < canvas.strokes.len(), "{hidden}");
                let is_middle = |stroke: &&Stroke| stroke.ends.iter().all(|end| (end[0] - 0.5).abs() < 0.1);
                assert!(canvas.strokes.iter().filter(is_middle).all(|stroke| stroke.is_hidden));
                canvas.strokes.clear();
                canvas.line([[-2.0, 0.1, 2.0], [2.0, 0.1, 2.0]], [1; 3]);
                assert!(canvas.strokes.iter().all(|stroke| !stroke.is_hidden));
                canvas.spot([0.0, 0.0, -3.0], [1; 3]);
                canvas.spot([0.0, 0.0, 9.0], [1; 3]);
                assert!(canvas.spots.len() == 1 && canvas.spots[0].is_hidden, "behind the eye is nothing");
            });
        }
    }

    #[test]
    fn line_through_the_eye_is_drawn_where_it_is_before_the_eye() {
        canvas(1, |_, canvas| {
            canvas.line([[0.1, 0.1, 20.0], [0.1, 0.1, 2.0]], [1; 3]);
            assert!(!canvas.strokes.is_empty());
            assert!(canvas.strokes.iter().flat_map(|stroke| stroke.ends).flatten().all(f32::is_finite));
        });
    }

    #[test]
    fn silhouette_and_volume_of_a_cube_have_its_six_edges_and_corners() {
        canvas(1, |caster, canvas| {
            let light: Light = "directional:-1,-1,-1".parse().unwrap();
            let (mesh, topology) = (caster.mesh(), caster.topology());
            let silhouette = caster.silhouette(&light, CasterFaces::Front);
            canvas.silhouette(mesh, topology, &silhouette);
            let length = |stroke: &Stroke| {
                let [[a, b], [c, d]] = stroke.ends;
                (80.0 * (a - c)).hypot(60.0 * (b - d))
            };
            let drawn: f32 = canvas.strokes.iter().map(length).sum();
            // Each edge, by its projection.
            let size = Size::new(80, 60).unwrap();
            let camera = Camera::look_at([0.0, 0.0, 6.0], [0.0; 3], 0.9, Up::Y).unwrap();
            let rays = camera.rays(size);
            let whole: f64 = silhouette
                .edges
                .iter()
                .map(|edge| {
                    let [a, b] = topology
                        .vertices(edge.edge)
                        .map(|v| rays.project(mesh.positions()[v.index()]).unwrap());
                    (a.x_px - b.x_px).hypot(a.y_px - b.y_px)
                })
                .sum();
            assert!(silhouette.edges.len() == 6 && (f64::from(drawn) - whole).abs() < 1e-3 * whole);
            canvas.strokes.clear();
            canvas.volume(mesh, topology, &silhouette, &light, 3.5);
            assert!(canvas.strokes.iter().all(|stroke| stroke.color == VOLUME) && canvas.strokes.len() > 6);
        });
    }
}
