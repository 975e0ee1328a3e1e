use super::shaders::{shader, with_body};
use super::*;
use crate::facing::{CasterFaces, FacePlanes, classify};
use crate::gpu::tests::gpu;
use crate::testing::shapes;
use crate::topology::{GpuTopology, Topology};
use proptest::prelude::*;

fn shaders() -> Option<SilhouetteShaders> {
    static SHADERS: std::sync::OnceLock<Option<SilhouetteShaders>> = std::sync::OnceLock::new();
    SHADERS.get_or_init(|| gpu().map(|gpu| SilhouetteShaders::new(&gpu).unwrap())).clone()
}

fn topology(mesh: &Mesh) -> Topology {
    Topology::of(mesh)
}

fn on_device(shaders: &SilhouetteShaders, mesh: &Mesh, planes: &FacePlanes) -> GpuSilhouette {
    let topology = GpuTopology::upload(shaders.gpu(), &topology(mesh)).unwrap();
    let caster = GpuCaster::with_planes(shaders, mesh, topology, planes).unwrap();
    GpuSilhouette::new(&caster).unwrap()
}

/// Small grids for ties, places far from the origin, and both ends of the range.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        (-4_i8..=4).prop_map(f32::from),
        -1.0_f32..1.0,
        (-4_i8..=4).prop_map(|x| f32::from(x) + 1000.0),
        (-1.0_f32..1.0).prop_map(|x| x * 1e-30),
        (-1.0_f32..1.0).prop_map(|x| x * 1e30),
        any::<f32>().prop_filter("finite", |x| x.is_finite()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn silhouette_sides_of_the_device_equal_the_predicate_face_by_face(
        positions in prop::collection::vec([coordinate(), coordinate(), coordinate()], 3..30),
        picks in prop::collection::vec([any::<u32>(), any::<u32>(), any::<u32>()], 1..100),
        lights in prop::collection::vec((coordinate(), coordinate(), coordinate(), any::<bool>()), 1..6),
    ) {
        let Some(shaders) = shaders() else { return Ok(()) };
        let n = positions.len() as u32;
        let triangles = picks.into_iter().map(|corners| corners.map(|c| c % n)).collect();
        let on_vertex = Light::point(positions[0]).unwrap();
        let mesh = Mesh::new(positions, triangles).unwrap();
        let silhouette = on_device(&shaders, &mesh, &FacePlanes::new(&mesh));
        let lights = lights.into_iter().map(|(x, y, z, directional)| match Light::directional([x, y, z]) {
            Ok(light) if directional => light,
            _ => Light::point([x, y, z]).unwrap(),
        });
        for light in lights.chain([on_vertex]) {
            silhouette.classify(&mesh, &light).unwrap();
            prop_assert_eq!(silhouette.download_facing().unwrap(), classify(&mesh, &light));
        }
    }
}

#[test]
fn silhouette_shader_is_laid_out_as_rust_writes_it() {
    let module = naga::front::wgsl::parse_str(shader().source()).unwrap();
    let members = |name: &str| {
        let found = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name));
        let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = found else {
            panic!("{name} is a structure");
        };
        let offsets = members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize));
        (offsets.collect::<Vec<_>>(), *span as usize)
    };
    let owned =
        |members: &[(&str, usize)]| members.iter().map(|&(n, o)| (n.to_owned(), o)).collect::<Vec<_>>();
    let light = [
        ("l", std::mem::offset_of!(LightParameters, xyz)),
        ("reach", std::mem::offset_of!(LightParameters, reach)),
        ("lowest", std::mem::offset_of!(LightParameters, floor)),
        ("faces", std::mem::offset_of!(LightParameters, faces)),
        ("padding", std::mem::offset_of!(LightParameters, padding)),
    ];
    assert_eq!(std::mem::offset_of!(LightParameters, w), 12, "the fourth of `l`");
    assert_eq!(members("Light"), (owned(&light), size_of::<LightParameters>()));
    assert_eq!(members("Patch"), (owned(&[("word", 0), ("keep", 4), ("bits", 8)]), size_of::<[u32; 3]>()));
    assert_eq!(members("Unsure").0, owned(&[("count", 0), ("faces", 4)]));
    assert_eq!(members("Found").0, owned(&[("edges", 0), ("quads", 4), ("list", 8)]));
}

#[test]
fn silhouette_of_the_device_equals_the_processors() {
    let Some(shaders) = shaders() else { return };
    for mesh in [shapes::cube(), shapes::menger_sponge(2), shapes::icosphere(3), shapes::book(7)] {
        let (topology, planes) = (topology(&mesh), FacePlanes::new(&mesh));
        let silhouette = on_device(&shaders, &mesh, &planes);
        for light in ["point:3,4,5", "point:0,0,0", "directional:0,-1,0", "point:1e12,-1e11,7"] {
            let light: Light = light.parse().unwrap();
            let facing = classify(&mesh, &light);
            for casters in [CasterFaces::All, CasterFaces::Front] {
                silhouette.set_masks(&vec![casters.mask(); mesh.face_count()]).unwrap();
                let found = silhouette.find(&mesh, &light).unwrap();
                assert_eq!(silhouette.download_facing().unwrap(), facing, "{} {light}", mesh.name);
                let expected = Silhouette::extract(&topology, &casters.signs(&facing));
                assert_eq!(found.silhouette, expected, "{} {light}", mesh.name);
                assert_eq!(found.unsure_faces, silhouette.download_unsure_count().unwrap());
            }
        }
    }
}

/// Planes exactly through the local origin: with the light there every face is a tie.
fn planes_through_the_origin() -> Mesh {
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for i in 0..150_u16 {
        let grid = |k: u16| f32::from((i * k) % 251) / 256.0;
        let (a, b) = ([grid(7), -grid(31), grid(57)], [-grid(101), grid(13), grid(89) - 0.5]);
        let corners = [a, b, [0, 1, 2].map(|axis| -(a[axis] + b[axis]))];
        positions.extend(corners);
        positions.extend(corners.map(|p| p.map(|x| -x)));
    }
    Mesh::new(positions, (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

#[test]
fn silhouette_filter_without_the_error_of_planes_is_caught() {
    let Some(shaders) = shaders() else { return };
    let mesh = planes_through_the_origin();
    let light = Light::point([0.0; 3]).unwrap();
    let mut planes = FacePlanes::new(&mesh);
    let facing_with = |planes: &FacePlanes| {
        let silhouette = on_device(&shaders, &mesh, planes);
        silhouette.classify(&mesh, &light).unwrap();
        silhouette.download_facing().unwrap()
    };
    let expected = classify(&mesh, &light);
    assert_eq!(facing_with(&planes), expected);
    planes.forget_errors(); // the sabotage
    assert_ne!(facing_with(&planes), expected);
}

#[test]
fn silhouette_unsure_face_taken_as_front_is_caught() {
    let Some(shaders) = shaders() else { return };
    let mesh = shapes::menger_sponge(1);
    let silhouette = on_device(&shaders, &mesh, &FacePlanes::new(&mesh));
    let light = Light::directional([0.0, -1.0, 0.0]).unwrap();
    let unsure = silhouette.unsure_faces(&light).unwrap();
    assert!(!unsure.is_empty());
    silhouette.settle(unsure.iter().map(|&face| (face, Facing::Front))).unwrap(); // the sabotage
    let facing = classify(&mesh, &light);
    assert_ne!(silhouette.download_facing().unwrap(), facing);
    let expected = Silhouette::extract(&topology(&mesh), &CasterFaces::All.signs(&facing));
    assert_ne!(silhouette.extract().unwrap(), expected);
}

#[test]
fn silhouette_multiplicity_capped_at_one_is_caught() {
    let Some(gpu) = gpu() else { return };
    let body = include_str!("../silhouette.wgsl");
    let sabotaged = body.replace("multiplicities[edge] = m;", "multiplicities[edge] = sign(m);");
    assert_ne!(body, sabotaged);
    let mesh = shapes::icosphere(1);
    let light = Light::point([0.37, 0.21, 11.0]).unwrap(); // every edge counts twice
    let expected = Silhouette::extract(&topology(&mesh), &CasterFaces::All.signs(&classify(&mesh, &light)));
    let find = |body: &str| {
        let shaders = SilhouetteShaders::compiled(&gpu, &with_body(body)).unwrap();
        on_device(&shaders, &mesh, &FacePlanes::new(&mesh)).find(&mesh, &light).unwrap().silhouette
    };
    assert_eq!(find(body), expected);
    assert_ne!(find(&sabotaged), expected);
}

#[test]
fn silhouette_recorded_for_several_lights_in_one_encoder_keeps_them_apart() {
    let Some(shaders) = shaders() else { return };
    let mesh = shapes::icosphere(3);
    let topology = topology(&mesh);
    let one = on_device(&shaders, &mesh, &FacePlanes::new(&mesh));
    let vertices = shaders.gpu().upload("vertices", mesh.positions()).unwrap();
    let uploaded = GpuTopology::upload(shaders.gpu(), &topology).unwrap();
    let other = GpuSilhouette::new(&GpuCaster::deforming(&shaders, vertices, 1.0, uploaded)).unwrap();
    let lights = ["point:3,4.125,5.5", "directional:0.3,-1,0.2"].map(|light| light.parse::<Light>().unwrap());
    let again = GpuSilhouette::new(one.caster()).unwrap();
    shaders
        .gpu()
        .submit(|encoder| {
            one.record(encoder, &lights[0]).unwrap();
            other.record(encoder, &lights[0]).unwrap();
            again.record(encoder, &lights[1]).unwrap();
        })
        .unwrap();
    for (silhouette, light) in [(one, lights[0]), (other, lights[0]), (again, lights[1])] {
        // In general position f32 is right.
        assert_eq!(silhouette.download_unsure_count().unwrap(), 0);
        let facing = classify(&mesh, &light);
        assert_eq!(silhouette.download_facing().unwrap(), facing);
        let expected = Silhouette::extract(&topology, &CasterFaces::All.signs(&facing));
        assert_eq!(silhouette.extract().unwrap(), expected);
    }
}
