//! Silhouette edges in the space of a map, in a tree of boxes.

use glam::DVec3;

use super::light_map::{LightMap, Receiver};
use crate::facing::CasterFaces;
use crate::shadow::map::{LightSpace, Spread, wide};

/// Edges per leaf.
const LEAF: usize = 4;
/// The part of the near distance at which edges are cut off before the light. Nothing that casts within the
/// map is nearer than all of it.
const NEAREST: f64 = 0.5;

/// The exact silhouette of all casters, in each layer of a map.
#[derive(Debug)]
pub(super) struct Edges {
    layers: Vec<Tree>,
    /// Mean depth of the edges' middles.
    pub(super) mean_depth: f64,
}

/// Depth is affine along an edge: ends are column, row and depth.
type Edge = [DVec3; 2];

/// A binary tree over one layer's edges: node `k` has the children `2k + 1` and `2k + 2`.
#[derive(Debug, Default)]
struct Tree {
    edges: Vec<Edge>,
    nodes: Vec<[DVec3; 2]>,
}

impl Edges {
    pub(super) fn of(map: &LightMap<'_>) -> Self {
        let space = map.space();
        let mut found: Vec<Vec<Edge>> = vec![Vec::new(); space.layers()];
        for caster in map.casters.casters() {
            let (mesh, topology) = (caster.mesh(), caster.topology());
            for edge in caster.silhouette(map.lamp.light(), CasterFaces::All).edges {
                let ends = topology.vertices(edge.edge).map(|vertex| wide(mesh.positions()[vertex.index()]));
                for (layer, found) in found.iter_mut().enumerate() {
                    found.extend(projected(space, layer, ends));
                }
            }
        }
        let count = found.iter().map(Vec::len).sum::<usize>().max(1);
        let sum: f64 = found.iter().flatten().map(|[a, b]| 0.5 * (a.z + b.z)).sum();
        Self { layers: found.into_iter().map(Tree::of).collect(), mean_depth: sum / count as f64 }
    }

    pub(super) fn bytes(&self) -> usize {
        let of_tree = |tree: &Tree| size_of_val(&*tree.edges) + size_of_val(&*tree.nodes);
        self.layers.iter().map(of_tree).sum()
    }

    /// The least distance from the receiver to an edge above its plane, over the penumbra's half-width of
    /// that edge; at most 1. `width` is the width along the wider axis, of a depth and its height above the
    /// plane; it grows with both.
    pub(super) fn nearest(&self, receiver: &Receiver<'_>, width: impl Fn(f64, f64) -> f64) -> f64 {
        let query = Query::of(receiver);
        self.layers[receiver.layer].nearest(&query, &width)
    }
}

/// The part of an edge before the light that may matter in one layer.
fn projected(space: &LightSpace, layer: usize, [mut a, mut b]: [DVec3; 2]) -> Option<Edge> {
    if let Spread::Central { near, .. } = space.spread() {
        let axis = space.frame(layer).axis;
        let ahead = |p: DVec3| (p - space.origin()).dot(axis) - NEAREST * near;
        let (at_a, at_b) = (ahead(a), ahead(b));
        if at_a < 0.0 && at_b < 0.0 {
            return None;
        }
        let cut = a + (b - a) * (at_a / (at_a - at_b));
        if at_a < 0.0 {
            a = cut;
        } else if at_b < 0.0 {
            b = cut;
        }
    }
    let side = f64::from(space.size());
    let [a, b] = [a, b].map(|p| space.at_layer(layer, p).map(|at| DVec3::new(at.tx, at.ty, at.d)));
    let (a, b) = (a?, b?);
    // As far beside the layer as texels are searched.
    let (low, high) = (a.min(b), a.max(b));
    let is_near = (0..2).all(|axis| high[axis] >= -side && low[axis] <= 2.0 * side);
    is_near.then_some([a, b])
}

/// What the tree is asked.
struct Query<'r, 'a> {
    receiver: &'r Receiver<'a>,
    at: DVec3,
    /// By how much distances along each axis count more.
    aspect: DVec3,
}

impl<'r, 'a> Query<'r, 'a> {
    fn of(receiver: &'r Receiver<'a>) -> Self {
        let k = receiver.k[0].max(receiver.k[1]);
        let [x, y] = receiver.k.map(|own| if own > 0.0 { k / own } else { 1.0 });
        let at = DVec3::new(receiver.at[0], receiver.at[1], 0.0);
        Self { receiver, at, aspect: DVec3::new(x, y, 0.0) }
    }

    /// A bound below the values of all edges in a box.
    fn bound(&self, [low, high]: [DVec3; 2], width: &impl Fn(f64, f64) -> f64) -> f64 {
        let away = (low - self.at).max(self.at - high).max(DVec3::ZERO) * self.aspect;
        let plane = self.receiver.least_plane([low.x, low.y], [high.x, high.y]);
        part(away.length(), high.z, high.z - plane, width)
    }

    fn value(&self, [a, b]: Edge, width: &impl Fn(f64, f64) -> f64) -> f64 {
        let [from, along] = [(a - self.at) * self.aspect, (b - a) * self.aspect];
        let squared = along.length_squared();
        let t = if squared > 0.0 { (-from.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
        let place = a + (b - a) * t;
        let plane = self.receiver.least_plane([place.x, place.y], [place.x, place.y]);
        part((from + along * t).length(), place.z, place.z - plane - self.receiver.rounding(), width)
    }
}

/// Distance over width; 1 where that is more, or where the edge does not lie above the plane.
fn part(distance: f64, depth: f64, above: f64, width: &impl Fn(f64, f64) -> f64) -> f64 {
    if above > 0.0 { (distance / width(depth, above)).min(1.0) } else { 1.0 }
}

impl Tree {
    fn of(mut edges: Vec<Edge>) -> Self {
        let leaves = edges.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![[DVec3::INFINITY, DVec3::NEG_INFINITY]; 2 * leaves - 1];
        fill(&mut nodes, 0, &mut edges, leaves);
        Self { edges, nodes }
    }

    fn nearest(&self, query: &Query<'_, '_>, width: &impl Fn(f64, f64) -> f64) -> f64 {
        let leaves = self.nodes.len().div_ceil(2);
        let mut least = 1.0;
        self.descend(0, 0..self.edges.len(), leaves, query, width, &mut least);
        least
    }

    fn descend(
        &self,
        node: usize,
        range: std::ops::Range<usize>,
        leaves: usize,
        query: &Query<'_, '_>,
        width: &impl Fn(f64, f64) -> f64,
        least: &mut f64,
    ) {
        if range.is_empty() || query.bound(self.nodes[node], width) >= *least {
            return;
        }
        if leaves == 1 {
            for &edge in &self.edges[range] {
                *least = least.min(query.value(edge, width));
            }
            return;
        }
        let middle = range.start + range.len() / 2;
        let children = [(2 * node + 1, range.start..middle), (2 * node + 2, middle..range.end)];
        let bounds = [0, 1].map(|k| query.bound(self.nodes[children[k].0], width));
        let [near, far] = if bounds[1] < bounds[0] { [1, 0] } else { [0, 1] };
        for k in [near, far] {
            self.descend(children[k].0, children[k].1.clone(), leaves / 2, query, width, least);
        }
    }
}

/// Boxes of a node and of all below it; edges are sorted into halves along the longer axis. The depth of the
/// recursion is the logarithm of their number.
fn fill(nodes: &mut [[DVec3; 2]], node: usize, edges: &mut [Edge], leaves: usize) {
    let bounds = edges.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], [a, b]| {
        [low.min(*a).min(*b), high.max(*a).max(*b)]
    });
    nodes[node] = bounds;
    if leaves == 1 || edges.is_empty() {
        return;
    }
    let size = bounds[1] - bounds[0];
    let axis = usize::from(size.y > size.x);
    let middle = edges.len() / 2;
    let key = |[a, b]: &Edge| a[axis] + b[axis];
    edges.select_nth_unstable_by(middle, |p, q| {
        // Ties by all numbers, so that the order does not depend on the input's.
        let all = |[a, b]: &Edge| [a.x, a.y, a.z, b.x, b.y, b.z];
        key(p).total_cmp(&key(q)).then_with(|| {
            all(p)
                .iter()
                .zip(all(q))
                .map(|(x, y)| x.total_cmp(&y))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        })
    });
    let (left, right) = edges.split_at_mut(middle);
    fill(nodes, 2 * node + 1, left, leaves / 2);
    fill(nodes, 2 * node + 2, right, leaves / 2);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::{Caster, CasterGroup};
    use crate::shadow::Samples;
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn edges_in_the_tree_equal_a_loop_over_all_edges() {
        let mut inside = 0;
        for mesh in [shapes::torus_knot(2, 3, 60, 9, 0.4), shapes::menger_sponge(1)] {
            let caster = Caster::new(mesh);
            let casters = CasterGroup::new(vec![&caster]);
            let size = Size::new(24, 18).unwrap();
            let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
            let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
            for lamp in
                ["directional:0.3,0.2,-1,angle=6", "rect:0,0,6:2,0,0:0,1,1", "point:0,0.2,1,radius=0.3"]
            {
                let map = LightMap::prepare(&casters, &lamp.parse().unwrap(), 64).unwrap();
                let edges = Edges::of(&map);
                for hit in samples.hits().iter().flatten() {
                    let Some(receiver) = map.receiver(hit).filter(|receiver| receiver.is_sound()) else {
                        continue;
                    };
                    let k = receiver.k[0].max(receiver.k[1]);
                    let width = |_: f64, above: f64| k * above;
                    let query = Query::of(&receiver);
                    let all = edges.layers[receiver.layer].edges.iter();
                    let brute = all.fold(1.0_f64, |least, &edge| least.min(query.value(edge, &width)));
                    assert_eq!(edges.nearest(&receiver, width), brute, "{lamp}");
                    inside += u32::from(brute < 1.0);
                }
            }
        }
        assert!(inside > 40, "{inside}");
    }
}
