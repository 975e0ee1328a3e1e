//! Pictures against a renderer that tests every triangle, at known positions, and as files.

#[cfg(feature = "gpu")]
mod stencil;

use glam::{DVec3, Vec3};

use umbrage::geom::predicate::{Sign, side_of_point};
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::{Intersection, Oracle, Verdict, intersect};
use umbrage::render::{CLAY, Ground, Line, Marker, Overlay, Picture, ShadedLight, View};
use umbrage::testing::shapes;
use umbrage::view::{Camera, Ray, Size, Up};

const QUIET: &(dyn Fn(u64) + Sync) = &|_| ();

fn size(text: &str) -> Size {
    text.parse().unwrap()
}

fn light(text: &str) -> Light {
    text.parse().unwrap()
}

fn bounds(mesh: &Mesh) -> Aabb {
    let [low, high] = mesh.bounds().unwrap();
    Aabb { low, high }
}

/// A sphere of radius 1 at height 2, and the floor at height 0.
fn sphere_over_floor() -> Mesh {
    let sphere = shapes::translated(&shapes::icosphere(3), [0.0, 2.0, 0.0]);
    let floor = Mesh::new(
        vec![[-20.0, 0.0, 20.0], [20.0, 0.0, 20.0], [20.0, 0.0, -20.0], [-20.0, 0.0, -20.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    Mesh::concat(&[sphere, floor.unwrap()]).unwrap()
}

fn view<'a>(camera: Camera, size: Size, lamps: &'a [ShadedLight]) -> View<'a> {
    View {
        camera,
        size,
        lamps,
        casters: None,
        up: Up::Y,
        ground: None,
        paint: &|_| CLAY,
        edge_samples: 1,
        ambient: None,
    }
}

/// The verdict by a loop over all triangles.
fn naive_verdict(mesh: &Mesh, p: [f32; 3], light: &Light) -> Verdict {
    let faces = (0..mesh.face_count()).map(|face| intersect(p, light, mesh.corners(FaceId::new(face))));
    faces.fold(Verdict::Lit, |verdict, meeting| match (verdict, meeting) {
        (Verdict::Shadowed, _) | (_, Intersection::Crossing(_)) => Verdict::Shadowed,
        (_, Intersection::Touching) => Verdict::Grazing,
        _ => verdict,
    })
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// The side of the face on which a naive shadow ray starts.
#[derive(Clone, Copy, PartialEq)]
enum Stand {
    Before,
    Behind,
}

/// The shading model, written down once more: linear light of one ray, or `None` for the background.
fn naive_light(mesh: &Mesh, view: &View<'_>, ray: Ray, stand: Stand) -> Option<Vec3> {
    let (eye, direction) = (ray.origin, ray.direction);
    let away = Light::directional(direction.map(|x| -x)).unwrap();
    let (face, t) = (0..mesh.face_count())
        .map(FaceId::new)
        .filter(|&face| intersect(eye, &away, mesh.corners(face)) != Intersection::None)
        .filter(|&face| !side_of_point(mesh.corners(face), eye).is_zero())
        .map(|face| {
            let [a, b, c] = mesh.corners(face).map(wide);
            let normal = (b - a).cross(c - a);
            (face, normal.dot(a - wide(eye)) / normal.dot(wide(direction)))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let corners = mesh.corners(face);
    let side = side_of_point(corners, eye);
    let wanted = if stand == Stand::Before { side } else { -side };
    // Small steps along the ray until the point lies on the requested side.
    let step = if stand == Stand::Before { -1e-7 } else { 1e-7 };
    let point = (0..10_000)
        .map(|i| (wide(eye) + wide(direction) * (t + f64::from(i) * step)).as_vec3().to_array())
        .find(|&p| side_of_point(corners, p) == wanted)
        .expect("a few steps leave the plane");

    let [a, b, c] = corners.map(wide);
    let mut normal = (b - a).cross(c - a).normalize().as_vec3();
    if side == Sign::Negative {
        normal = -normal;
    }
    let base = Vec3::from((view.paint)(face));
    let mut sum = base * (0.17 + 0.07 * normal.y);
    for lamp in view.lamps {
        if naive_verdict(mesh, point, &lamp.light) == Verdict::Shadowed {
            continue;
        }
        let [x, y, z, w] = lamp.light.homogeneous();
        let l = (DVec3::new(x.into(), y.into(), z.into()) - wide(point) * f64::from(w)).normalize().as_vec3();
        let h = (l - Vec3::from(direction).normalize()).normalize();
        let diffuse = normal.dot(l);
        if diffuse > 0.0 {
            sum += Vec3::from(lamp.color) * (base * diffuse + 0.12 * normal.dot(h).max(0.0).powi(32));
        }
    }
    Some(sum)
}

/// Linear light of an sRGB byte below the shoulder, which starts at 0.75 (a byte of 225).
fn linear(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Renders a small picture, which must fit the memory.
fn render(oracle: &Oracle, view: &View<'_>, progress: &(dyn Fn(u64) + Sync)) -> Picture {
    umbrage::render::render(oracle, view, progress).unwrap()
}

/// Number of pixels of `picture` that the naive renderer contradicts.
fn contradictions(mesh: &Mesh, view: &View<'_>, picture: &Picture, stand: Stand) -> usize {
    let rays = view.camera.rays(view.size);
    let empty = render(&Oracle::build(&Mesh::default()), view, QUIET);
    let width = view.size.width() as usize;
    let differs = |at: &usize| {
        let (x, y) = (at % width, at / width);
        let ray = rays.ray(x as f64 + 0.5, y as f64 + 0.5);
        let pixel = picture.pixels[*at];
        match naive_light(mesh, view, ray, stand) {
            None => pixel != empty.pixels[*at],
            Some(light) => (0..3).any(|i| {
                let [low, high] = [pixel[i].saturating_sub(1), pixel[i].saturating_add(1)].map(linear);
                light[i].min(0.75) < low.min(0.75) - 1e-6 || light[i].min(0.75) > high + 1e-6
            }),
        }
    };
    (0..view.size.pixels()).filter(differs).count()
}

#[test]
fn picture_agrees_with_a_renderer_that_asks_every_triangle() {
    let knot = shapes::translated(&shapes::torus_knot(2, 3, 40, 6, 0.4), [0.0, 3.0, 0.0]);
    let sphere = shapes::translated(&shapes::icosphere(1), [3.0, 1.5, 1.0]);
    let scenes = [
        Mesh::concat(&[knot, sphere, shapes::scaled(&shapes::sheet(3), 5.0)]).unwrap(),
        shapes::menger_sponge(1),
        shapes::open_cube(),
    ];
    for mesh in scenes {
        let bounds = bounds(&mesh);
        let far = 2.0 * bounds.diagonal() as f32;
        let lights = [Light::point([far, far, 0.3 * far]).unwrap(), light("directional:0.3,-1,-0.2")];
        let lamps = ShadedLight::equal(&lights);
        let size = size("64x48");
        let fitted = Camera::fit(&bounds, Up::Y, size.aspect());
        let parallel = fitted.orthographic(1.5 * bounds.diagonal() as f32).unwrap();
        let pictures = [fitted, parallel].map(|camera| {
            let view = view(camera, size, &lamps);
            let picture = render(&Oracle::build(&mesh), &view, QUIET);
            assert_eq!(contradictions(&mesh, &view, &picture, Stand::Before), 0);
            // The fault: from behind its face every lit point shadows itself.
            let acne = contradictions(&mesh, &view, &picture, Stand::Behind);
            assert!(acne > 150, "{acne} pixels of acne");
            picture
        });
        // The fault: the picture of the other camera.
        let mixed_up = contradictions(&mesh, &view(fitted, size, &lamps), &pictures[1], Stand::Before);
        assert!(mixed_up > 300, "{mixed_up}");
    }
}

#[test]
fn picture_of_a_sphere_over_a_floor_is_dark_where_the_light_is_hidden() {
    let mesh = sphere_over_floor();
    let lamp = light("point:1,8,1");
    let lamps = ShadedLight::equal(&[lamp]);
    let size = size("160x120");
    let camera = Camera::look_at([0.0, 7.0, 12.0], [0.0, 1.0, 0.0], 0.7, Up::Y).unwrap();
    let view = view(camera, size, &lamps);
    let picture = render(&Oracle::build(&mesh), &view, QUIET);
    let rays = camera.rays(size);
    // On the line from the light through the sphere's middle the floor is met at (−1/3, 0, −1/3).
    let places = [
        ([-0.33, 0.0, -0.33], Verdict::Shadowed),
        ([-0.8, 0.0, 0.6], Verdict::Shadowed),
        ([4.0, 0.0, 1.0], Verdict::Lit),
        ([-4.0, 0.0, 2.0], Verdict::Lit),
    ];
    for (place, expected) in places {
        let at = rays.project(place).unwrap();
        let (x, y) = (at.x_px as usize, at.y_px as usize);
        let ray = rays.ray(x as f64 + 0.5, y as f64 + 0.5);
        let eye_sees = Oracle::build(&mesh).first_visible(ray.origin, ray.direction).unwrap();
        assert!(eye_sees.face.index() >= mesh.face_count() - 2, "{place:?} is hidden");
        assert_eq!(naive_verdict(&mesh, eye_sees.point, &lamp), expected);
        let [red, ..] = picture.pixels[y * size.width() as usize + x];
        assert_eq!(red < 130, expected == Verdict::Shadowed, "{place:?}: {red}");
    }
}

#[test]
fn picture_bytes_do_not_depend_on_the_number_of_threads() {
    let (mesh, ground) = Ground::under(shapes::torus_knot(2, 3, 60, 8, 0.4), Up::Y).unwrap();
    let oracle = Oracle::build(&mesh);
    let lamps = ShadedLight::equal(&[light("point:3,6,4"), light("directional:0.3,-1,-0.2")]);
    let size = size("96x64");
    let camera = Camera::fit(&bounds(&shapes::torus_knot(2, 3, 60, 8, 0.4)), Up::Y, size.aspect());
    let view = View { ground: Some(ground), edge_samples: 2, ..view(camera, size, &lamps) };
    let steps = std::sync::atomic::AtomicU64::new(0);
    let count = |n| {
        steps.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
    };
    let picture = render(&oracle, &view, &count);
    assert_eq!(steps.into_inner(), view.steps());
    assert_ne!(picture, render(&oracle, &View { lamps: &lamps[..1], ..view }, QUIET));
    #[cfg(feature = "parallel")]
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| render(&oracle, &view, QUIET)), picture);
    }
    assert_eq!(render(&oracle, &view, QUIET), picture);
}

#[test]
fn picture_with_smooth_edges_differs_at_edges_only() {
    let mesh = shapes::cube();
    let lamps = ShadedLight::equal(&[light("directional:0.3,-1,-0.2")]);
    let size = size("64x48");
    let plain = view(Camera::fit(&bounds(&mesh), Up::Y, size.aspect()), size, &lamps);
    let oracle = Oracle::build(&mesh);
    let smooth = render(&oracle, &View { edge_samples: 3, ..plain }, QUIET);
    let plain = render(&oracle, &plain, QUIET);
    let changed = plain.pixels.iter().zip(&smooth.pixels).filter(|(a, b)| a != b).count();
    assert!((40..600).contains(&changed), "{changed} pixels changed");
}

#[test]
fn png_reads_back_and_is_the_same_each_time() {
    let mesh = shapes::icosphere(1);
    let lamps = ShadedLight::equal(&[light("point:3,6,4")]);
    let size = size("33x17");
    let view = view(Camera::fit(&bounds(&mesh), Up::Y, size.aspect()), size, &lamps);
    let picture = render(&Oracle::build(&mesh), &view, QUIET);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    picture.write_png(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut again = Vec::new();
    picture.encode_png(&mut again).unwrap();
    assert_eq!(bytes, again);

    let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height, info.color_type), (33, 17, png::ColorType::Rgba));
    assert!(reader.info().srgb.is_some());
    assert_eq!(pixels, picture.pixels.as_flattened());
    let error = picture.write_png(folder.path().join("no/a.png")).unwrap_err();
    assert!(error.to_string().contains("there is no folder"), "{error}");
}

#[test]
fn overlay_lines_are_bright_in_front_and_dim_behind() {
    let mesh = shapes::cube();
    let oracle = Oracle::build(&mesh);
    let Aabb { low, high } = oracle.bounds();
    let size = size("160x120");
    let red = [255, 0, 0];
    // The vertical edge nearest to the fitted camera, and the hidden one: positions away from their corners.
    let heights = [0.25, 0.5].map(|part| low[1] + part * (high[1] - low[1]));
    let edge = |x: f32, z: f32| Line { ends: heights.map(|y| [x, y, z]), color: red };
    let plain = Overlay::default().render(&oracle, Up::Y, size, QUIET).unwrap();
    let redness = |line: Line| {
        let picture =
            Overlay { lines: vec![line], ..Overlay::default() }.render(&oracle, Up::Y, size, QUIET).unwrap();
        let gains = plain.pixels.iter().zip(&picture.pixels);
        gains.map(|(a, b)| i32::from(a[1]) - i32::from(b[1])).max().unwrap()
    };
    let (front, back) = (redness(edge(high[0], high[2])), redness(edge(low[0], low[2])));
    assert!(front > 150 && back < front / 2 && back > 20, "{front} {back}");
}

#[test]
fn overlay_draws_spots_and_tints() {
    let mesh = shapes::cube();
    let oracle = Oracle::build(&mesh);
    let size = size("160x120");
    let blue = [0, 0, 255];
    let is_blue = |pixel: &[u8; 4]| pixel[2] > 150 && pixel[0] < 60;
    let count = |overlay: Overlay| {
        let picture = overlay.render(&oracle, Up::Y, size, QUIET).unwrap();
        picture.pixels.iter().filter(|pixel| is_blue(pixel)).count()
    };
    assert_eq!(count(Overlay::default()), 0);
    let spot = Marker { at: oracle.bounds().high, color: blue };
    let spots = count(Overlay { spots: vec![spot], ..Overlay::default() });
    assert!((40..90).contains(&spots), "{spots}"); // a disc of radius 4.5
    let faces = (0..12).map(|face| (FaceId(face), blue)).collect();
    assert!(count(Overlay { faces, ..Overlay::default() }) > 1000);
}

#[test]
fn overlay_survives_places_at_the_ends_of_the_range() {
    let oracle = Oracle::build(&shapes::cube());
    let most = f32::MAX;
    let places = [[most; 3], [-most; 3], [0.0; 3], [most, 0.0, -most], [f32::from_bits(1); 3]];
    let ends = places.iter().flat_map(|&a| places.map(|b| [a, b]));
    let overlay = Overlay {
        lines: ends.map(|ends| Line { ends, color: [255, 0, 0] }).collect(),
        spots: places.map(|at| Marker { at, color: [255, 0, 0] }).to_vec(),
        faces: vec![(FaceId(999), [255, 0, 0])],
        order: vec![[255, 0, 0]; 99],
    };
    for text in ["1x1", "5x300", "64x48"] {
        assert_eq!(overlay.render(&oracle, Up::Z, size(text), QUIET).unwrap().size, size(text));
    }
}
