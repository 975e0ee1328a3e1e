//! Extruding a volume: its triangles, in memory that is kept.

use std::fmt;
use std::ops::Range;

use super::cap::{CapFaces, turned};
use super::{Caps, ShadowVolume, cap};
use crate::geom::Light;
use crate::mesh::{Mesh, VertexId};
use crate::parallel;
use crate::silhouette::{Silhouette, SilhouetteEdge};
use crate::topology::{Topology, has_collapsed};

/// What a volume is extruded from.
#[derive(Clone, Copy, Debug)]
pub struct ExtrudeInput<'a> {
    /// The caster.
    pub mesh: &'a Mesh,
    /// Its topology.
    pub topology: &'a Topology,
    /// The light that it is extruded away from.
    pub light: &'a Light,
    /// The sign that each face casts with: −1, 0 or +1. A face that a point light lies on should have 0.
    pub signs: &'a [i8],
    /// The silhouette of these signs.
    pub silhouette: &'a Silhouette,
    /// Which caps are wanted.
    pub caps: Caps,
}

/// The ranges of the parts of a volume among its triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VolumeParts {
    /// The casting faces, turned towards the light.
    pub light_cap: Range<usize>,
    /// The quads that the silhouette edges sweep.
    pub sides: Range<usize>,
    /// The light cap at infinity, reversed. Empty for a directional light.
    pub dark_cap: Range<usize>,
}

impl VolumeParts {
    /// How many triangles there are.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.dark_cap.end
    }
}

/// The error of a buffer with fewer slots than a volume has triangles; nothing was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferTooSmall {
    /// How many triangles the volume has.
    pub needed: usize,
    /// How many fit into the buffer.
    pub room: usize,
}

impl fmt::Display for BufferTooSmall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { needed, room } = self;
        write!(
            f,
            "index buffer: the volume has {needed} triangles and there is room for {room}; make it larger"
        )
    }
}

impl std::error::Error for BufferTooSmall {}

/// Extrudes one mesh for light after light, and allocates nothing once its buffers have grown.
///
/// Two ways out: [`Extruder::extrude_into`] makes a whole [`ShadowVolume`] in the memory of an earlier one,
/// and [`Extruder::write_indices`] writes nothing but indices, over vertices that need not be written again
/// for another light, which is what a renderer wants. With the feature `parallel` the caps of large meshes
/// are shared by threads; the bytes are the same.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// use umbrage::facing::{CasterFaces, FacePlanes};
/// use umbrage::silhouette::Silhouette;
/// use umbrage::shadow::volume::{Caps, ExtrudeInput, Extruder};
/// let mesh = shapes::icosphere(3);
/// let topology = Topology::of(&mesh);
/// let (planes, mut extruder) = (FacePlanes::new(&mesh), Extruder::new(&topology));
/// let (mut facing, mut signs, mut silhouette) = (Vec::new(), Vec::new(), Silhouette::default());
/// let mut buffer = vec![[0; 3]; 4 * mesh.face_count()]; // mapped memory of a renderer, say
/// for step in 0..3_u8 {
///     let light = Light::point([3.0, 4.0, f32::from(step)])?;
///     planes.classify_into(&mesh, &light, &mut facing);
///     CasterFaces::All.signs_into(&facing, &mut signs);
///     silhouette.extract_into(&topology, &signs);
///     let cast = ExtrudeInput {
///         mesh: &mesh,
///         topology: &topology,
///         light: &light,
///         signs: &signs,
///         silhouette: &silhouette,
///         caps: Caps::Both,
///     };
///     let parts = extruder.write_indices(&cast, &mut buffer)?;
///     assert!(parts.triangle_count() > 2 * parts.light_cap.len()); // both caps and the sides
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Extruder {
    /// Every vertex is a corner of a face that has not collapsed.
    whole: bool,
    /// Casting faces before each chunk of faces, and of all.
    starts: Vec<u32>,
    used: Vec<bool>,
    /// The index of each vertex among those that are used.
    numbers: Vec<u32>,
}

impl Extruder {
    /// Prepares for casters of this topology. One pass over the faces.
    #[must_use]
    pub fn new(topology: &Topology) -> Self {
        let mut extruder = Self::unprepared();
        extruder.used.resize(topology.vertex_count(), false);
        for triangle in topology.triangles().iter().filter(|&&triangle| !has_collapsed(triangle)) {
            triangle.iter().for_each(|&v| extruder.used[v as usize] = true);
        }
        extruder.whole = extruder.used.iter().all(|&used| used);
        extruder
    }

    /// For one volume alone, for which preparations do not pay.
    pub(super) fn unprepared() -> Self {
        Self { whole: false, starts: Vec::new(), used: Vec::new(), numbers: Vec::new() }
    }

    /// As [`ShadowVolume::extrude`], in place of an earlier volume, whose memory is kept.
    ///
    /// # Panics
    ///
    /// Panics if signs, mesh and topology have different numbers of faces, or if the silhouette names an edge
    /// or a vertex that topology and mesh do not have. The volume is then of no use.
    pub fn extrude_into(&mut self, cast: &ExtrudeInput<'_>, volume: &mut ShadowVolume) {
        let parts = self.parts(cast);
        let mesh = cast.mesh;
        volume.light = *cast.light;
        let faces = if cast.caps == Caps::Both { mesh.face_count() } else { 0 };
        let all_cast = parts.light_cap.len() == faces - self.collapsed(cast) && faces > 0;
        let vertex_count = mesh.vertex_count();
        let identity = (self.whole && all_cast && cast.topology.vertex_count() == vertex_count)
            || self.number(cast) == vertex_count;
        volume.positions.clear();
        volume.casters.clear();
        if identity {
            volume.positions.extend_from_slice(mesh.positions());
            volume.casters.extend((0..vertex_count).map(VertexId::new));
        } else {
            let casters = self.used.iter().enumerate().filter(|(_, used)| **used);
            volume.casters.extend(casters.map(|(v, _)| VertexId::new(v)));
            volume.positions.extend(volume.casters.iter().map(|v| mesh.positions()[v.index()]));
        }
        let count = volume.casters.len() as u32; // at most the vertices
        volume.extruded.clear();
        // A directional light sends every vertex to one point.
        volume.extruded.extend(0..if cast.light.is_directional() { count.min(1) } else { count });
        (volume.light_cap, volume.sides) = (parts.light_cap.len(), parts.sides.len());
        let total = parts.triangle_count();
        if volume.triangles.capacity() < total {
            volume.triangles = vec![[0; 3]; total];
        }
        volume.triangles.resize(total, [0; 3]);
        if identity {
            self.write(cast, &parts, |v| v, count, &mut volume.triangles);
        } else {
            let numbers = &self.numbers;
            self.write(cast, &parts, |v| numbers[v as usize], count, &mut volume.triangles);
        }
    }

    /// The ranges of the parts of the volume among its triangles: how large a buffer has to be.
    ///
    /// # Panics
    ///
    /// Panics if signs, mesh and topology have different numbers of faces.
    #[must_use]
    pub fn parts(&mut self, cast: &ExtrudeInput<'_>) -> VolumeParts {
        assert_eq!(cast.signs.len(), cast.mesh.face_count(), "one sign per face");
        assert_eq!(cast.topology.face_count(), cast.mesh.face_count(), "the topology is of another mesh");
        let cap = if cast.caps == Caps::Both {
            cap::count(cast.mesh.triangles(), cast.signs, self.collapsed(cast) > 0, &mut self.starts)
        } else {
            self.starts.clear();
            0
        };
        let copies: usize =
            cast.silhouette.edges.iter().map(|edge| edge.multiplicity.unsigned_abs() as usize).sum();
        let directional = cast.light.is_directional();
        let sides = cap + if directional { copies } else { 2 * copies };
        let end = if directional { sides } else { sides + cap };
        VolumeParts { light_cap: 0..cap, sides: cap..sides, dark_cap: sides..end }
    }

    /// Writes the triangles of the volume, over vertices that are the same for every light: vertex `v` of the
    /// mesh is vertex `v`, and at infinity vertex `n + v` of a mesh of `n` vertices, or `n` for all of them
    /// where the light is directional. Otherwise they are those of [`ShadowVolume::triangles`], in the same
    /// order.
    ///
    /// Every byte of the volume is written once and none is read, as suits mapped memory; what lies beyond
    /// the volume is left as it is. A buffer of `2·(faces + Σ|m|)` triangles is always enough, where m are
    /// the multiplicities of the silhouette.
    ///
    /// # Errors
    ///
    /// If the buffer has too little room: then nothing is written.
    ///
    /// # Panics
    ///
    /// As [`Extruder::extrude_into`], and if the mesh has more than 2³¹ vertices and the light is a point:
    /// then `n + v` does not fit in 32 bits, while [`Extruder::extrude_into`] numbers only vertices that are
    /// used. The contents of the buffer are then unspecified.
    pub fn write_indices(
        &mut self,
        cast: &ExtrudeInput<'_>,
        buffer: &mut [[u32; 3]],
    ) -> Result<VolumeParts, BufferTooSmall> {
        let parts = self.parts(cast);
        let (needed, room) = (parts.triangle_count(), buffer.len());
        let buffer = buffer.get_mut(..needed).ok_or(BufferTooSmall { needed, room })?;
        let first = first_at_infinity(cast.mesh.vertex_count(), cast.light.is_directional());
        self.write(cast, &parts, |v| v, first, buffer);
        Ok(parts)
    }

    fn collapsed(&self, cast: &ExtrudeInput<'_>) -> usize {
        if cast.caps == Caps::Both { cast.topology.collapsed_face_count() } else { 0 }
    }

    /// Numbers the vertices that are used, in the order of the caster. Returns how many there are.
    fn number(&mut self, cast: &ExtrudeInput<'_>) -> usize {
        let Self { used, numbers, .. } = self;
        used.clear();
        used.resize(cast.mesh.vertex_count(), false);
        if cast.caps == Caps::Both {
            for (&triangle, &sign) in cast.mesh.triangles().iter().zip(cast.signs) {
                if sign != 0 && !has_collapsed(triangle) {
                    triangle.iter().for_each(|&v| used[v as usize] = true);
                }
            }
        }
        for edge in &cast.silhouette.edges {
            cast.topology.vertices(edge.edge).iter().for_each(|v| used[v.index()] = true);
        }
        let mut count = 0;
        numbers.clear();
        numbers.extend(used.iter().map(|&used| {
            count += u32::from(used);
            count - u32::from(used)
        }));
        count as usize
    }

    /// Writes all triangles for vertices with these numbers, and those numbers plus `count` at infinity.
    fn write(
        &self,
        cast: &ExtrudeInput<'_>,
        parts: &VolumeParts,
        number: impl Fn(u32) -> u32 + Copy + Send + Sync,
        count: u32,
        triangles: &mut [[u32; 3]],
    ) {
        let (light_cap, rest) = triangles.split_at_mut(parts.light_cap.len());
        let (side, dark_cap) = rest.split_at_mut(parts.sides.len());
        if parts.light_cap.is_empty() {
            return write_sides(Sides::of(cast), number, count, side);
        }
        let faces = CapFaces {
            triangles: cast.mesh.triangles(),
            signs: cast.signs,
            collapsed: self.collapsed(cast) > 0,
            starts: &self.starts,
        };
        let mut caps = || cap::fill(faces, number, count, light_cap, dark_cap);
        if faces.are_many() {
            parallel::join(caps, || write_sides(Sides::of(cast), number, count, side));
        } else {
            caps();
            write_sides(Sides::of(cast), number, count, side);
        }
    }
}

/// The index of the first vertex at infinity, after all others.
pub(super) fn first_at_infinity(vertices: usize, directional: bool) -> u32 {
    let at_infinity = if directional { 1 } else { vertices };
    assert!(
        vertices as u64 + at_infinity as u64 <= 1 << 32,
        "{vertices} vertices and as many at infinity have no 32-bit numbers"
    );
    vertices as u32 // a mesh has fewer than 2³² − 1
}

/// What the sides of a volume are made of.
pub(super) struct Sides<'a, I> {
    pub(super) mesh: &'a Mesh,
    pub(super) topology: &'a Topology,
    pub(super) directional: bool,
    /// The silhouette, ascending.
    pub(super) edges: I,
}

impl<'a> Sides<'a, std::iter::Copied<std::slice::Iter<'a, SilhouetteEdge>>> {
    fn of(cast: &ExtrudeInput<'a>) -> Self {
        let ExtrudeInput { mesh, topology, light, silhouette, .. } = *cast;
        Self { mesh, topology, directional: light.is_directional(), edges: silhouette.edges.iter().copied() }
    }
}

/// Writes |m| copies of the quad of each silhouette edge. The diagonal of a quad depends on the positions of
/// its ends only, so that coincident quads of two meshes agree.
pub(super) fn write_sides(
    Sides { mesh, topology, directional, edges }: Sides<'_, impl Iterator<Item = SilhouetteEdge>>,
    number: impl Fn(u32) -> u32,
    count: u32,
    triangles: &mut [[u32; 3]],
) {
    let far = |near: u32| if directional { count } else { count + near };
    let mut slots = triangles.iter_mut();
    let mut put = |triangle| *slots.next().expect("they were counted") = triangle;
    let positions = mesh.positions();
    for SilhouetteEdge { edge, multiplicity: m } in edges {
        let [a, b] = topology.vertices(edge);
        let swap = lexicographically_less(positions[b.index()], positions[a.index()]);
        let (a, b, m) = if swap { (b, a, -m) } else { (a, b, m) };
        let (a, b) = (number(a.0), number(b.0));
        for _ in 0..m.unsigned_abs() {
            put(turned([b, a, far(a)], m < 0));
            if !directional {
                put(turned([b, far(a), far(b)], m < 0));
            }
        }
    }
}

fn lexicographically_less(a: [f32; 3], b: [f32; 3]) -> bool {
    a.partial_cmp(&b).is_some_and(std::cmp::Ordering::is_lt)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::facing::{CasterFaces, classify};
    use crate::mesh::FaceId;
    use crate::testing::{shapes, strategy};

    /// The volume triangle by triangle over the caster's own vertices, `v` and `n + v`, as the definition has
    /// it.
    fn naive(cast: &ExtrudeInput<'_>) -> Vec<[u32; 3]> {
        let ExtrudeInput { mesh, topology, light, signs, silhouette, caps } = *cast;
        let n = mesh.vertex_count() as u32;
        let far = |v: u32| if light.is_directional() { n } else { n + v };
        let faces: Vec<usize> = (0..mesh.face_count())
            .filter(|&f| caps == Caps::Both && signs[f] != 0 && !topology.is_collapsed(FaceId::new(f)))
            .collect();
        let reversed = |[a, b, c]: [u32; 3]| [a, c, b];
        let mut triangles = Vec::new();
        for &face in &faces {
            let triangle = mesh.triangles()[face];
            triangles.push(if signs[face] > 0 { triangle } else { reversed(triangle) });
        }
        for edge in &silhouette.edges {
            let [a, b] = topology.vertices(edge.edge).map(|v| v.0);
            let [p, q] = [a, b].map(|v| mesh.positions()[v as usize]);
            let (a, b, m) = if q < p { (b, a, -edge.multiplicity) } else { (a, b, edge.multiplicity) };
            for _ in 0..m.abs() {
                for triangle in [[b, a, far(a)], [b, far(a), far(b)]] {
                    if triangle[1] != triangle[2] {
                        triangles.push(if m > 0 { triangle } else { reversed(triangle) });
                    }
                }
            }
        }
        for &face in faces.iter().filter(|_| !light.is_directional()) {
            let triangle = mesh.triangles()[face].map(far);
            triangles.push(if signs[face] > 0 { reversed(triangle) } else { triangle });
        }
        triangles
    }

    /// The naive triangles over the vertices that are used alone, and which those are.
    fn compact(cast: &ExtrudeInput<'_>) -> (Vec<VertexId>, Vec<[u32; 3]>) {
        let (mut triangles, n) = (naive(cast), cast.mesh.vertex_count() as u32);
        let is_used = |v: u32| {
            let of_sides = cast.silhouette.edges.iter().flat_map(|edge| cast.topology.vertices(edge.edge));
            triangles.as_flattened().contains(&v) || of_sides.into_iter().any(|used| used.0 == v)
        };
        let used: Vec<u32> = (0..n).filter(|&v| is_used(v)).collect();
        let number = |v: u32| used.binary_search(&v).expect("it is used") as u32;
        for v in triangles.as_flattened_mut() {
            *v = match (*v < n, cast.light.is_directional()) {
                (true, _) => number(*v),
                (false, true) => used.len() as u32,
                (false, false) => used.len() as u32 + number(*v - n),
            };
        }
        (used.into_iter().map(VertexId).collect(), triangles)
    }

    fn agrees(extruder: &mut Extruder, cast: &ExtrudeInput<'_>, volume: &mut ShadowVolume) -> bool {
        extruder.extrude_into(cast, volume);
        let parts = extruder.parts(cast);
        let expected = naive(cast);
        // Slots past the end stay as they are.
        let mut buffer = vec![[9; 3]; expected.len() + 1];
        let written = extruder.write_indices(cast, &mut buffer).expect("there is room");
        let (casters, triangles) = compact(cast);
        written == parts
            && buffer.pop() == Some([9; 3])
            && buffer == expected
            && (volume.light_cap(), volume.sides(), volume.dark_cap())
                == (parts.light_cap.clone(), parts.sides.clone(), parts.dark_cap.clone())
            && (volume.casters(), volume.triangles()) == (&casters[..], &triangles[..])
            && volume.positions().iter().eq(casters.iter().map(|v| &cast.mesh.positions()[v.index()]))
    }

    fn empty(light: &Light) -> ShadowVolume {
        let mesh = Mesh::new(Vec::new(), Vec::new()).expect("nothing is wrong with it");
        let topology = Topology::build(0, Vec::new());
        ShadowVolume::extrude(&mesh, &topology, light, &[], &Silhouette::default(), Caps::Both)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn volume_written_in_kept_memory_equals_the_definition(
            mesh in strategy::soup(200),
            lights in prop::collection::vec(strategy::light(), 3),
            random in prop::collection::vec(-1_i8..=1, 200),
        ) {
            let topology = Topology::of(&mesh);
            let mut extruder = Extruder::new(&topology);
            let mut volume = empty(&lights[0]);
            for light in &lights {
                let facing = classify(&mesh, light);
                for signs in [CasterFaces::All.signs(&facing), CasterFaces::Front.signs(&facing), random[..mesh.face_count()].to_vec()] {
                    let silhouette = Silhouette::extract(&topology, &signs);
                    for caps in [Caps::Both, Caps::None] {
                        let cast = ExtrudeInput { mesh: &mesh, topology: &topology, light, signs: &signs, silhouette: &silhouette, caps };
                        prop_assert!(agrees(&mut extruder, &cast, &mut volume));
                        volume = ShadowVolume::extrude(&mesh, &topology, light, &signs, &silhouette, caps);
                        prop_assert_eq!(volume.triangles(), compact(&cast).1);
                    }
                }
            }
        }
    }

    /// Whether what is written for enough faces to be shared by threads is what the definition says for the
    /// same signs, but for those of one face.
    fn large_agrees(changed: Option<usize>) -> [bool; 3] {
        let mesh = shapes::torus(300, 150, 2.0, 0.75);
        let topology = Topology::of(&mesh);
        let light = &Light::point([3.0, 4.0, 5.0]).expect("finite");
        let mut extruder = Extruder::new(&topology);
        let facing = classify(&mesh, light);
        let stripes = (0..mesh.face_count()).map(|face| (face % 700 / 250) as i8 - 1).collect();
        [CasterFaces::All.signs(&facing), CasterFaces::Front.signs(&facing), stripes].map(|mut signs| {
            let silhouette = &Silhouette::extract(&topology, &signs);
            let (mesh, topology, caps) = (&mesh, &topology, Caps::Both);
            let cast = ExtrudeInput { mesh, topology, light, signs: &signs, silhouette, caps };
            let mut buffer = vec![[0; 3]; extruder.parts(&cast).triangle_count()];
            assert!(extruder.write_indices(&cast, &mut buffer).is_ok());
            if let Some(face) = changed {
                signs[face] -= 2 * signs[face].signum();
            }
            buffer == naive(&ExtrudeInput { mesh, topology, light, signs: &signs, silhouette, caps })
        })
    }

    #[test]
    fn volume_of_a_large_mesh_written_in_parts_equals_the_definition() {
        assert_eq!(large_agrees(None), [true; 3]);
    }

    #[test]
    fn volume_of_a_large_mesh_with_one_face_turned_is_caught() {
        let [all, _, stripes] = large_agrees(Some(89_650));
        assert!(!all && !stripes);
    }

    #[test]
    fn volume_in_a_buffer_that_is_too_small_is_refused_and_nothing_is_written() {
        let mesh = shapes::cube();
        let topology = Topology::of(&mesh);
        let light = Light::point([2.0, 3.0, 5.0]).expect("finite");
        let signs = CasterFaces::All.signs(&classify(&mesh, &light));
        let silhouette = Silhouette::extract(&topology, &signs);
        let cast = ExtrudeInput {
            mesh: &mesh,
            topology: &topology,
            light: &light,
            signs: &signs,
            silhouette: &silhouette,
            caps: Caps::Both,
        };
        let mut extruder = Extruder::new(&topology);
        let needed = extruder.parts(&cast).triangle_count();
        let mut buffer = vec![[7; 3]; needed - 1];
        let refused = extruder.write_indices(&cast, &mut buffer);
        assert_eq!(refused, Err(BufferTooSmall { needed, room: needed - 1 }));
        assert!(buffer.iter().all(|&triangle| triangle == [7; 3]));
        assert!(needed <= 2 * (mesh.face_count() + 2 * silhouette.edges.len()));
    }

    #[test]
    fn volume_whose_vertices_were_numbered_for_another_light_is_caught() {
        // The fault injected: a mesh whose vertices are not all used, taken for one that uses them all.
        let whole = shapes::cube();
        let mut positions = whole.positions().to_vec();
        positions.insert(0, [9.0; 3]);
        let shifted = whole.triangles().iter().map(|triangle| triangle.map(|v| v + 1)).collect();
        let mesh = Mesh::new(positions, shifted).expect("finite");
        let topology = Topology::of(&mesh);
        let light = Light::point([2.0, 3.0, 5.0]).expect("finite");
        let signs = CasterFaces::All.signs(&classify(&mesh, &light));
        let silhouette = Silhouette::extract(&topology, &signs);
        let (light, caps) = (&light, Caps::Both);
        let cast = ExtrudeInput {
            mesh: &mesh,
            topology: &topology,
            light,
            signs: &signs,
            silhouette: &silhouette,
            caps,
        };
        let mut extruder = Extruder::new(&topology);
        assert!(agrees(&mut extruder, &cast, &mut empty(light)));
        extruder.whole = true;
        assert!(!agrees(&mut extruder, &cast, &mut empty(light)));
    }

    #[test]
    fn extrude_numbers_no_more_vertices_than_thirty_two_bits_hold() {
        assert_eq!(first_at_infinity(1 << 31, false), 1 << 31);
        assert_eq!(first_at_infinity(u32::MAX as usize - 1, true), u32::MAX - 1);
        assert!(std::panic::catch_unwind(|| first_at_infinity((1 << 31) + 1, false)).is_err());
    }
}
