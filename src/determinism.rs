//! Determinism test: digests of all results are compared with constants, so every machine gives the same
//! bytes.
//!
//! These tests run with and without threads (`tests/run.sh` runs them with the default features and with
//! none). A change of any output, intended or not, changes a constant. The meshes are made without sines and
//! cosines, whose last bit may differ between platforms.

use crate::caster::{ShellBoxes, ShellProof};
use crate::check::{CrackReport, DefectKind};
use crate::facing::{CasterFaces, FacePlanes, classify};
use crate::geom::Light;
use crate::mesh::{FaceId, Mesh, Weld, weld};
use crate::oracle::Oracle;
use crate::read::read_bytes;
use crate::render::{CLAY, ShadedLight, View, render};
use crate::scene::Scope;
use crate::shadow::stencil::max_depth_complexity;
use crate::shadow::volume::{Caps, ShadowVolume, ShellFaces, WindingIndex};
use crate::silhouette::Silhouette;
use crate::testing::shapes;
use crate::topology::Topology;
use crate::view::{Camera, Size, Up};
use crate::write::{Layer, Model, Target, to_bytes};

/// FNV-1a hash of 64 bits (Glenn Fowler, Landon Curt Noll, Phong Vo, 1991): each byte is mixed in by an
/// exclusive or and a multiplication.
#[derive(Clone, Copy)]
struct Digest(u64);

impl Digest {
    fn of(bytes: &[u8]) -> u64 {
        bytes
            .iter()
            .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
    }

    /// Appends bytes with their length, so that the boundaries of texts and lists count too.
    fn add(&mut self, bytes: &[u8]) {
        self.0 = Self::of(&[&self.0.to_le_bytes(), &bytes.len().to_le_bytes()[..4], bytes].concat());
    }
}

/// Test meshes with their names; each name says what is special about the mesh.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let parts = [shapes::menger_sponge(2), shapes::translated(&shapes::icosphere(2), [4.0, 0.5, -1.0])];
    vec![
        ("sphere", shapes::shuffled(&shapes::icosphere(3), 7)),
        ("open cube", shapes::open_cube()),
        ("t-junction", shapes::t_junction()),
        ("nested", shapes::nested_cubes(6)),
        ("figure eight", shapes::figure_eight_prism()),
        ("double sheet", shapes::double_sheet()),
        ("two parts", Mesh::concat(&parts).unwrap()),
    ]
}

fn lights() -> [Light; 2] {
    [Light::point([3.0, 7.0, 5.0]).unwrap(), Light::directional([-1.0, -3.0, 2.0]).unwrap()]
}

/// Digest of everything computed from one mesh.
fn geometry(mesh: &Mesh) -> u64 {
    let mut digest = Digest(0);
    let mesh = weld(&shapes::soup(mesh), Weld::Exact).mesh;
    digest.add(bytemuck::cast_slice(mesh.positions()));
    digest.add(bytemuck::cast_slice(mesh.triangles()));
    let topology = Topology::of(&mesh);
    let shells = topology.shells();
    let mut report = CrackReport::of(&mesh, &topology);
    report.add_self_intersections(&mesh, &topology, 9);
    digest.add(format!("{:?} {:?} {:?}", report.counts, report.shell_list, report.near_miss).as_bytes());
    for kind in DefectKind::ALL {
        digest.add(format!("{:?}", report.items(kind, &mesh, &topology, 9)).as_bytes());
    }
    let proofs = ShellProof::of(&mesh, &topology, &shells);
    let planes = FacePlanes::new(&mesh);
    let oracle = Oracle::build(&mesh);
    for light in lights() {
        let facing = planes.classify(&mesh, &light);
        assert_eq!(facing, classify(&mesh, &light));
        digest.add(&facing.iter().map(|facing| facing.sign() as u8).collect::<Vec<_>>());
        let boxes = ShellBoxes::new(&mesh, &shells);
        let plan = ShellFaces::choose(&mesh, &boxes, &proofs, &light, None);
        for signs in [CasterFaces::All.signs(&facing), plan.signs(&shells, &facing)] {
            let silhouette = Silhouette::extract(&topology, &signs);
            digest.add(format!("{silhouette:?} {:?}", silhouette.loops(&topology)).as_bytes());
            let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
            digest.add(bytemuck::cast_slice(&volume.to_f32()));
            digest.add(bytemuck::cast_slice(&volume.clamped(50.0)));
            digest.add(bytemuck::cast_slice(volume.triangles()));
            digest.add(format!("{:?}", max_depth_complexity(&mesh, &signs, &light, 3)).as_bytes());
            let winding = WindingIndex::build(&volume, oracle.bounds());
            for step in 0..20_i16 {
                let p = [f32::from(step) / 8.0 - 1.0, 0.25, f32::from(step % 5) / 4.0];
                let said = (winding.number(p), oracle.verdict(p, &light), oracle.crossings(p, &light));
                digest.add(format!("{said:?}").as_bytes());
            }
        }
    }
    digest.0
}

/// Digest of all written files and of a picture.
fn files(mesh: &Mesh) -> u64 {
    let mut digest = Digest(0);
    let model = Model {
        layers: vec![Layer::from(mesh), Layer { color: Some([0.5, 0.25, 1.0, 0.5]), ..mesh.into() }],
    };
    for (name, target) in [("a.obj", Target::Obj), ("a.ply", Target::Ply), ("a.glb", Target::Glb)] {
        let bytes = to_bytes(&model, target).unwrap();
        digest.add(&bytes);
        for mesh in read_bytes(&bytes, name).unwrap().bake(Scope::Scene).unwrap() {
            digest.add(bytemuck::cast_slice(mesh.positions()));
            digest.add(bytemuck::cast_slice(mesh.triangles()));
        }
    }
    let camera = Camera::look_at([6.0, 5.0, 8.0], [0.5, 0.5, 0.5], 0.75, Up::Y).unwrap();
    let view = View {
        camera,
        size: Size::new(72, 48).unwrap(),
        lamps: &ShadedLight::equal(&lights()),
        casters: None,
        up: Up::Y,
        ground: None,
        paint: &|_: FaceId| CLAY,
        edge_samples: 2,
        ambient: None,
    };
    let picture = render(&Oracle::build(mesh), &view, &|_| {}).unwrap();
    let mut png = Vec::new();
    picture.encode_png(&mut png).unwrap();
    digest.add(picture.pixels.as_flattened());
    digest.add(&png);
    digest.0
}

/// Digest of a verification.
#[cfg(feature = "verify")]
fn verification(mesh: &Mesh) -> u64 {
    use crate::verify::points::{Options, Verifier};
    let caster = crate::caster::Caster::new(mesh.clone());
    let verifier = Verifier::new(&caster);
    let options = Options { points: 300, seed: 5, keep: 10 };
    let said = lights().map(|light| verifier.verify(&light, &options, &|_| {}));
    Digest::of(format!("{said:?}").as_bytes())
}

fn expect(wanted: &[(&str, u64)], of: fn(&Mesh) -> u64) {
    let found: Vec<(&str, u64)> = meshes().iter().map(|(name, mesh)| (*name, of(mesh))).collect();
    assert_eq!(found, wanted, "found {found:#x?}");
}

#[test]
fn digest_of_all_geometry_is_the_same_everywhere() {
    expect(&GEOMETRY, geometry);
}

#[test]
fn digest_of_files_and_pictures_is_the_same_everywhere() {
    expect(&FILES, files);
}

#[cfg(feature = "verify")]
#[test]
fn digest_of_a_verification_is_the_same_everywhere() {
    expect(&VERIFICATION, verification);
}

#[test]
fn digest_is_fnv_and_sees_one_bit() {
    // Test vectors of the authors of FNV.
    assert_eq!(
        [b"".as_slice(), b"a", b"foobar"].map(Digest::of),
        [0xcbf2_9ce4_8422_2325, 0xaf63_dc4c_8601_ec8c, 0x8594_4171_f739_67e8]
    );
    // Fault injected: the last bit of one coordinate of one vertex is flipped.
    let mesh = shapes::open_cube();
    let (mut positions, triangles, ..) = mesh.clone().into_parts();
    positions[0][1] = f32::from_bits(positions[0][1].to_bits() ^ 1);
    let changed = Mesh::new(positions, triangles).unwrap();
    assert_ne!(geometry(&mesh), geometry(&changed));
    assert_ne!(files(&mesh), files(&changed));
}

const GEOMETRY: [(&str, u64); 7] = [
    ("sphere", 0x47a9_5121_7619_65d4),
    ("open cube", 0xd47e_3239_fe52_7639),
    ("t-junction", 0xe8f3_566e_b01b_34f2),
    ("nested", 0xe392_ce73_db3b_7efc),
    ("figure eight", 0xd7c2_a117_c840_1a73),
    ("double sheet", 0x373f_e3b2_c73d_d3ab),
    ("two parts", 0xe76c_fbf0_d784_8696),
];
const FILES: [(&str, u64); 7] = [
    ("sphere", 0xeac0_ea2a_70f6_a01f),
    ("open cube", 0xa600_55a2_8402_02b6),
    ("t-junction", 0xcb69_b7f1_2e7a_6ad0),
    ("nested", 0x3817_3dab_5295_7c89),
    ("figure eight", 0x4333_6bf2_cc23_de8b),
    ("double sheet", 0x9e81_03c8_dcfc_1a6c),
    ("two parts", 0x0f8f_1a22_6964_2adb),
];
#[cfg(feature = "verify")]
const VERIFICATION: [(&str, u64); 7] = [
    ("sphere", 0xde2a_0f82_5529_2f9e),
    ("open cube", 0xa0c0_d3aa_e746_c115),
    ("t-junction", 0x693e_fb7b_edd2_568d),
    ("nested", 0xae19_fffb_9227_9c90),
    ("figure eight", 0x6c09_1d1f_c3d9_e877),
    ("double sheet", 0x2f88_8114_44fd_150b),
    ("two parts", 0x8bc1_33f2_1591_b148),
];
