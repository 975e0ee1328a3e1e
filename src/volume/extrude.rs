//! Emits the triangles of a volume.

use super::{Caps, ShadowVolume};
use crate::geom::Light;
use crate::mesh::{Mesh, VertexId};
use crate::silhouette::Silhouette;
use crate::topology::Topology;

pub(super) fn extrude(
    mesh: &Mesh,
    topology: &Topology,
    light: &Light,
    signs: &[i8],
    silhouette: &Silhouette,
    caps: Caps,
) -> ShadowVolume {
    assert_eq!(signs.len(), mesh.face_count(), "one sign a face");
    let casts = |face: usize| signs[face] != 0 && !topology.is_collapsed(crate::mesh::FaceId::new(face));
    let cap_faces: Vec<usize> = if caps == Caps::Both {
        (0..mesh.face_count()).filter(|&face| casts(face)).collect()
    } else {
        Vec::new()
    };
    let side_edges = silhouette.edges.iter().map(|edge| (topology.vertices(edge.edge), edge.multiplicity));

    // 1. Number the vertices that are used, in the caster's order: first as they are, then at infinity.
    let mut used = vec![false; mesh.vertex_count()];
    cap_faces.iter().for_each(|&face| mesh.triangles()[face].iter().for_each(|&v| used[v as usize] = true));
    side_edges.clone().for_each(|(ends, _)| ends.iter().for_each(|v| used[v.index()] = true));
    let casters: Vec<VertexId> = (0..used.len()).filter(|&v| used[v]).map(VertexId::new).collect();
    let mut near = vec![u32::MAX; mesh.vertex_count()];
    casters.iter().enumerate().for_each(|(i, v)| near[v.index()] = i as u32); // at most the vertices
    let count = casters.len() as u32;
    let far = |v: u32| if light.is_directional() { count } else { count + near[v as usize] };
    let extruded = match (light.is_directional(), count) {
        (_, 0) => Vec::new(),
        (true, _) => vec![0], // a directional light sends every vertex to one point
        (false, _) => (0..count).collect(),
    };

    // 2. The light cap: casting faces as the light sees them.
    let mut triangles = Vec::with_capacity(2 * cap_faces.len() + 2 * silhouette.edges.len());
    for &face in &cap_faces {
        triangles.push(turned(mesh.triangles()[face].map(|v| near[v as usize]), signs[face] < 0));
    }
    let light_cap = triangles.len();

    // 3. The sides: |m| copies of the quad of each silhouette edge. Its diagonal goes by the positions of its
    // ends, so that coincident quads of two meshes agree.
    for ([a, b], multiplicity) in side_edges {
        let swap = lexicographically_less(mesh.positions()[b.index()], mesh.positions()[a.index()]);
        let (a, b, m) = if swap { (b.0, a.0, -multiplicity) } else { (a.0, b.0, multiplicity) };
        let (a_near, b_near, a_far, b_far) = (near[a as usize], near[b as usize], far(a), far(b));
        for _ in 0..m.unsigned_abs() {
            triangles.push(turned([b_near, a_near, a_far], m < 0));
            if !light.is_directional() {
                triangles.push(turned([b_near, a_far, b_far], m < 0));
            }
        }
    }
    let sides = triangles.len() - light_cap;

    // 4. The dark cap: the light cap at infinity, reversed.
    if !light.is_directional() {
        for &face in &cap_faces {
            triangles.push(turned(mesh.triangles()[face].map(far), signs[face] > 0));
        }
    }
    let positions = casters.iter().map(|v| mesh.positions()[v.index()]).collect();
    ShadowVolume { light: *light, positions, casters, extruded, triangles, light_cap, sides }
}

fn turned([a, b, c]: [u32; 3], reverse: bool) -> [u32; 3] {
    if reverse { [a, c, b] } else { [a, b, c] }
}

fn lexicographically_less(a: [f32; 3], b: [f32; 3]) -> bool {
    a.partial_cmp(&b).is_some_and(std::cmp::Ordering::is_lt)
}
