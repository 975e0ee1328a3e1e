//! Lights and eyes at hard positions, by the stencil pass against counts in closed form.

use umbrage::Reason;
use umbrage::facing::CasterFaces;
use umbrage::mesh::Mesh;
use umbrage::shadow::stencil::StencilMethod;
use umbrage::testing::shapes;
use umbrage::view::Size;

use super::figures::*;
use super::screen::*;

/// A plate above the eye (or below the eye, if z < 8), with the extent [−half, half]².
fn cover(half: f32, z: f32) -> Mesh {
    plate([-half; 2], [half; 2], z)
}

fn within(x: f32, y: f32, half: f32) -> bool {
    x.abs().max(y.abs()) < half
}

/// Guards against casting front faces alone: a sheet casts the same shadow in either orientation.
#[test]
fn hard_01_sheet_throws_the_same_picture_from_either_side() {
    let sheet = cover(3.0, 16.0);
    let light = sun(0.0, 0.0, -1.0);
    for sheet in [sheet.clone(), shapes::inside_out(&sheet)] {
        let must = |x: f32, y: f32| counted(within(x, y, 3.0), 1);
        expect_pixels("a sheet", &walled(&[sheet]), &light, (0.5, 8.0), must);
    }
    // Negative test: with front faces alone, one of the two casts nothing.
    let turned = walled(&[shapes::inside_out(&sheet)]);
    let front = casting(&turned, Some(CasterFaces::Front));
    let Some(shot) = shoot_as(&front, &light, &plain(), Some(StencilMethod::ZFail), None) else { return };
    assert_eq!(shot.wrong(8.0, |x, y| counted(within(x, y, 3.0), 1)).len(), 36);
}

/// Guards against front-only casters around a lamp: seen from outside, the lamp's housing is dark everywhere.
#[test]
fn hard_02_light_inside_a_box_leaves_its_outside_dark() {
    let lamp = shapes::cuboid([-4.0, -4.0, -8.0], [4.0, 4.0, 0.0]);
    let light = point(0.1, 0.2, -3.0);
    let must = |x: f32, y: f32| if within(x, y, 4.0) { Pixel::Count(1) } else { Pixel::Sky };
    expect_pixels("a box", &lamp, &light, (0.5, 8.0), must);
    // From inside the housing is lit everywhere.
    let room = shapes::cuboid([-20.0, -20.0, -1.0], [20.0, 20.0, 30.0]);
    expect_pixels("a room", &room, &point(1.0, 2.0, 9.0), (0.5, 8.0), |_, _| Pixel::Count(0));
    // Negative test: front faces alone.
    let front = casting(&lamp, Some(CasterFaces::Front));
    let Some(shot) = shoot_as(&front, &light, &plain(), Some(StencilMethod::ZFail), None) else { return };
    assert_eq!(shot.wrong(8.0, must).len(), 64);
}

/// Guards against volumes of no extent: everything that an eye at the light's position sees is lit.
#[test]
fn hard_10_light_at_the_eye_lights_all_it_sees() {
    let scene = walled(&[
        shapes::cuboid([-2.0, -2.0, 1.0], [2.0, 2.0, 3.0]),
        cover(1.0, 5.0),
        placed(&shapes::icosphere(2), 1.5, [4.0, 4.0, 2.0]),
        cover(30.0, 16.0),
    ]);
    let by_zpass =
        expect_pixels("light at the eye", &scene, &point(0.0, 0.0, 8.0), (0.5, 8.0), |_, _| Pixel::Count(0));
    // Nothing lies between the eye and its near rectangle, so z-pass is proven correct for all five shells.
    assert!(by_zpass.is_none_or(|count| count == 5), "{by_zpass:?}");
    // Negative test: the light moved behind the cover.
    let Some(shot) = shoot(&scene, &point(0.0, 0.0, 24.0), &plain(), Some(StencilMethod::ZFail)) else {
        return;
    };
    assert!(shot.wrong(8.0, |_, _| Pixel::Count(0)).len() > 200);
}

/// Guards against z-pass with a caster between light and near rectangle, and against culling geometry because
/// it lies behind the eye.
#[test]
fn hard_10_light_behind_the_eye_throws_what_is_between_them() {
    let scene = walled(&[cover(1.0, 16.0)]);
    let light = point(0.0, 0.0, 24.0);
    // Eight above the plate, and twenty-four above the wall: the shadow is three times as large as the plate.
    let must = |x: f32, y: f32| counted(within(x, y, 3.0), 1);
    let by_zpass = expect_pixels("light behind the eye", &scene, &light, (0.5, 8.0), must);
    assert!(by_zpass.is_none_or(|count| count == 1), "the wall alone: {by_zpass:?}");
    let Some(shot) = shoot(&scene, &light, &plain(), None) else { return };
    let choice = shot.casting.methods.choices[1];
    assert_eq!((choice.what, choice.why), (StencilMethod::ZFail, Reason::MayLieBetween));
    let reason = "a face of the shell may lie between the light and the near rectangle of the camera";
    assert_eq!(choice.to_string(), reason);
    // Negative test: z-pass nevertheless.
    let Some(shot) = shoot(&scene, &light, &plain(), Some(StencilMethod::ZPass)) else { return };
    assert!(!shot.wrong(8.0, must).is_empty() && !shot.comparison.agrees());
}

/// Guards against projecting the light. At the near plane's level the light has w = near and an image; behind
/// this level it has none.
#[test]
fn hard_10_light_in_the_near_plane_casts_across_the_view() {
    // A vertical plate out of view at x = 12, |y| ≤ 2, 3 ≤ z ≤ 5.
    let upright = Mesh::new(
        vec![[12.0, -2.0, 3.0], [12.0, 2.0, 3.0], [12.0, 2.0, 5.0], [12.0, -2.0, 5.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    )
    .unwrap();
    let scene = walled(&[upright]);
    // From (20, 0, 7) through the plate to the wall: x runs from −8 to 6, and the image widens with the
    // distance.
    let must = |x: f32, y: f32| counted(x < 6.0 && y.abs() < (20.0 - x) / 4.0, 1);
    expect_pixels("light in the near plane", &scene, &point(20.0, 0.0, 7.0), (1.0, 8.0), must);
    let Some(shot) = shoot(&scene, &point(20.0, 0.0, 6.0), &view(1.0, 8.0), Some(StencilMethod::ZFail))
    else {
        return;
    };
    assert!(!shot.wrong(8.0, must).is_empty(), "the sabotage: the light one unit lower");
}

/// Guards against squaring coordinates in f32, and against a v − L that rounds away v.
#[test]
fn hard_10_light_at_two_to_the_fortieth_is_nearly_a_sun() {
    let far = 2.0_f32.powi(40);
    for (x, z) in [(0.0, far), (far, far), (-far, far)] {
        let shift = if x == 0.0 { 0.0 } else { 16.0 * x.signum() };
        let scene = walled(&[plate([shift - 3.0, -2.0], [shift + 3.0, 2.0], 16.0)]);
        let must = |x: f32, y: f32| counted(x.abs() < 3.0 && y.abs() < 2.0, 1);
        expect_pixels("light at 2^40", &scene, &point(x, 0.0, z), (0.5, 8.0), must);
        let Some(shot) = shoot(&scene, &point(x + 0.25 * far, 0.0, z), &plain(), Some(StencilMethod::ZFail))
        else {
            return;
        };
        assert!(!shot.wrong(8.0, must).is_empty(), "the sabotage: the light a quarter to the side");
    }
    let (lamp, day) = (point(0.3 * far, 0.5 * far, 0.7 * far), sun(-0.3, -0.5, -0.7));
    for mesh in [shapes::cube(), shapes::icosphere(2), shapes::torus(24, 12, 2.0, 0.5)] {
        // The point light sees the same sides as the directional light, and has a dark cap.
        assert_eq!(figures(&mesh, &lamp), figures(&mesh, &day), "{}", mesh.name);
        expect_agreement(&mesh, &lamp);
    }
}

/// Guards against deciding a side for faces parallel to the light: two thirds of the sponge are edge-on.
#[test]
fn hard_10_light_along_an_axis_leaves_most_of_a_sponge_edge_on() {
    let sponge = shapes::menger_sponge(1);
    for light in [sun(0.0, 0.0, -1.0), sun(-2.0, 0.0, 0.0), sun(0.0, 1e-30, 0.0)] {
        // Per side of the light: eight unit squares on a level, in a ring of 16 edges, and four single
        // squares within.
        expect_figures(&[(&sponge, light, ([24, 24, 96], 64, 64))]);
        expect_agreement(&sponge, &light);
    }
    for cell in 0..9 {
        let (x, y) = (cell % 3, cell / 3);
        // A corner column is solid, a column at the middle of an edge has a gap, the central column is empty.
        let crossed = [2, 4, 0][usize::from(x == 1) + usize::from(y == 1)];
        expect_crossings(&sponge, &sun(0.0, 0.0, -1.0), &[([x as f32 + 0.3, y as f32 + 0.1, -2.0], crossed)]);
    }
    // Behind the eye, at height sixteen, each cell 2 × 2 pixels.
    let scene = walled(&[placed(&sponge, 2.0, [-3.0, -3.0, 16.0])]);
    let column = |x: f32| (-3.0..3.0).contains(&x).then(|| usize::from((-1.0..1.0).contains(&x)));
    let must = |x: f32, y: f32| Pixel::Count(column(x).zip(column(y)).map_or(0, |(x, y)| [2, 4, 0][x + y]));
    expect_pixels("a sponge", &scene, &sun(0.0, 0.0, -1.0), (0.5, 8.0), must);
    let cube = walled(&[placed(&shapes::menger_sponge(0), 6.0, [-3.0, -3.0, 16.0])]);
    let Some(shot) = shoot(&cube, &sun(0.0, 0.0, -1.0), &plain(), Some(StencilMethod::ZFail)) else { return };
    assert_eq!(shot.wrong(8.0, must).len(), 5 * 4, "the sabotage: a cube without holes");
}

/// Guards against z-pass from inside a volume, which is off by one for every pixel.
#[test]
fn hard_11_eye_inside_a_volume_counts_what_an_eye_outside_counts() {
    let light = point(0.0, 0.0, 24.0);
    for layers in 1..=3_u8 {
        let covers: Vec<Mesh> = (0..layers).map(|k| cover(12.0, 14.0 + f32::from(k))).collect();
        let scene = walled(&covers);
        let must = |_, _| Pixel::Count(layers.into());
        let by_zpass = expect_pixels("eye in the volume", &scene, &light, (0.5, 8.0), must);
        assert!(by_zpass.is_none_or(|count| count == 1));
        let Some(shot) = shoot(&scene, &light, &plain(), Some(StencilMethod::ZPass)) else { return };
        assert_eq!(shot.wrong(8.0, must).len(), 256, "the sabotage: z-pass all the same");
        assert!(!shot.comparison.agrees());
    }
}

/// Guards against a near plane that opens volumes: the plane of a side passes through the eye itself.
#[test]
fn hard_11_eye_in_the_plane_of_a_side_that_the_near_plane_cuts() {
    for near in [0.01, 0.5, 6.0] {
        let scene = walled(&[plate([0.0, -12.0], [12.0, 12.0], 16.0)]);
        let light = sun(0.0, 0.0, -1.0);
        let must = |x: f32, _: f32| counted(x > 0.0, 1);
        expect_pixels("a side through the eye", &scene, &light, (near, 8.0), must);
        let Some(shot) = shoot(&scene, &light, &view(near, 8.0), Some(StencilMethod::ZPass)) else { return };
        assert!(!shot.wrong(8.0, must).is_empty(), "the sabotage: z-pass all the same");
    }
}

/// Guards against a caster that stops casting where it is clipped.
#[test]
fn hard_11_eye_before_a_near_plane_that_cuts_the_caster() {
    // The near plane at z = 4 cuts a box from 3 to 6: its floor and walls are seen from inside, below its
    // lid.
    let light = point(0.0, 0.0, 40.0);
    let cut = walled(&[shapes::cuboid([-2.0, -2.0, 3.0], [2.0, 2.0, 6.0])]);
    let must = |x: f32, y: f32| counted(within(x, y, 4.0), 1);
    expect_pixels("a box that is cut open", &cut, &light, (4.0, 8.0), must);

    // A ramp from z = 2 to z = 6 over −2 ≤ x ≤ 2: the half with x > 0 is clipped, and still casts its shadow.
    let ramp = Mesh::new(
        vec![[-2.0, -2.0, 2.0], [2.0, -2.0, 6.0], [2.0, 2.0, 6.0], [-2.0, 2.0, 2.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let ramp = walled(&[ramp.unwrap()]);
    let must = |x: f32, y: f32| {
        // The segment from the wall to the light meets the plane of the ramp at this x.
        let at = 36.0 * x / (40.0 + x);
        counted(x > 0.0 && at < 2.0 && y.abs() < 80.0 / (36.0 - at), 1)
    };
    expect_pixels("a ramp that is cut", &ramp, &light, (4.0, 8.0), must);
    let Some(shot) = shoot(&ramp, &light, &view(0.5, 8.0), Some(StencilMethod::ZFail)) else { return };
    assert!(!shot.wrong(8.0, must).is_empty(), "the sabotage: a near plane that cuts nothing");
}

/// Guards against guard bands and planes that lose digits in wide views.
#[test]
fn hard_11_eye_with_a_field_of_view_of_120_degrees() {
    let reach = 8.0 * 3.0_f32.sqrt();
    let scene = walled(&[cover(1.0, 16.0), shapes::cuboid([5.0, -9.0, 1.0], [7.0, -6.0, 2.0])]);
    let light = point(0.0, 0.0, 24.0);
    let must = |x: f32, y: f32| match within(x, y, 3.0) {
        true => Pixel::Count(1),
        // Near the box lie its shadow and its sides; only pixels far from the box have a closed form.
        false if x > 3.0 && y < -3.0 => Pixel::Either,
        false => Pixel::Count(0),
    };
    for near in [0.01, 0.5, 2.0] {
        expect_pixels("a wide view", &scene, &light, (near, reach), must);
    }
    let Some(shot) = shoot(&scene, &light, &view(0.5, 8.0), Some(StencilMethod::ZFail)) else { return };
    assert!(!shot.wrong(reach, must).is_empty(), "the sabotage: a view of 90 degrees");
}

/// Guards against manual clipping: the volume extends from in front of the eye to behind the eye, through w =
/// 0.
#[test]
fn hard_12_geometry_behind_the_eye_and_volumes_through_w_zero() {
    // The light lies between wall and box. The lid faces the eye and is dark, and the volume continues past
    // the eye.
    let lamp = point(0.0, 0.0, 2.0);
    let below = walled(&[shapes::cuboid([-1.0, -1.0, 4.0], [1.0, 1.0, 5.0])]);
    // The lid lies at depth 3; its visible points are behind lid and floor.
    let must = |x: f32, y: f32| counted(within(x, y, 8.0 / 3.0), 2);
    let by_zpass = expect_pixels("a volume past the eye", &below, &lamp, (0.5, 8.0), must);
    assert!(by_zpass.is_none_or(|count| count == 1), "{by_zpass:?}");

    // Casters all around the eye: none in view, none between the light and a visible point.
    let around = walled(&[
        shapes::cuboid([-30.0, -30.0, 7.0], [-25.0, 30.0, 9.0]),
        shapes::cuboid([-5.0, -5.0, 10.0], [5.0, 5.0, 12.0]),
        shapes::cuboid([25.0, -30.0, 7.5], [30.0, 30.0, 8.5]),
    ]);
    expect_pixels("casters behind the eye", &around, &point(0.5, 0.25, 9.0), (0.5, 8.0), |_, _| {
        Pixel::Count(0)
    });
    // With a sun from below, only the wall itself blocks the light.
    expect_pixels("a sun from below", &around, &sun(0.01, 0.02, 1.0), (0.5, 8.0), |_, _| Pixel::Count(1));
    // Negative test: the light above the middle caster.
    let Some(shot) = shoot(&around, &point(0.5, 0.25, 20.0), &plain(), Some(StencilMethod::ZFail)) else {
        return;
    };
    assert_eq!(shot.wrong(8.0, |_, _| Pixel::Count(0)).len(), 256);
}

/// Guards against pixels without a surface: the volume covers the sky too, where nothing can be dark.
#[test]
fn hard_18_sky_behind_an_infinite_volume_is_no_shadow() {
    // From 2 above the plate the volume opens to the entire view; the plate hides the center of the view.
    let scene = cover(2.0, 4.0);
    let light = point(0.0, 0.0, 6.0);
    let must = |x: f32, y: f32| if within(x, y, 4.0) { Pixel::Count(0) } else { Pixel::Sky };
    expect_pixels("a plate in the sky", &scene, &light, (0.5, 8.0), must);
    let Some(shot) = shoot(&scene, &light, &plain(), Some(StencilMethod::ZFail)) else { return };
    // Negative test: the raw counts put all of the sky into the volume.
    let raw = shot.mask.raw();
    let inside = raw.iter().filter(|&&count| count == 1).count();
    assert_eq!((inside, raw.len()), (192, Size::new(16, 16).unwrap().pixels()));
    // A picture of an empty mesh is sky everywhere.
    expect_pixels("nothing", &Mesh::default(), &light, (0.5, 8.0), |_, _| Pixel::Sky);
}

/// Guards against a dark cap of a directional light, which is a single point: its triangles would be
/// rasterized as noise.
#[test]
fn hard_19_dark_cap_of_a_sun_is_one_point_at_infinity() {
    for (mesh, faces, sum) in
        [(shapes::cube(), 12, 12), (shapes::octahedron(), 8, 12), (shapes::sheet(3), 18, 12)]
    {
        let (day, far) = (sun(-3.0, -5.0, -7.5), 2.0_f32.powi(40));
        let volume = shadow(&mesh, &day);
        assert_eq!(volume.dark_cap().len(), 0);
        assert_eq!((volume.light_cap().len(), volume.sides().len()), (faces, sum));
        // All vertices of the caster except unreferenced ones, and one at infinity: the light's direction of
        // travel.
        assert_eq!(volume.vertex_count(), mesh.vertex_count() + 1);
        assert_eq!(volume.vertex(mesh.vertex_count() as u32).to_f64(), [-3.0, -5.0, -7.5, 0.0]);
        assert!(volume.boundary_sum().is_closed());
        // Negative test: a point light in the same direction needs the cap, and twice as many sides.
        let near = shadow(&mesh, &point(3.0 * far, 5.0 * far, 7.5 * far));
        assert_eq!((near.dark_cap().len(), near.sides().len()), (faces, 2 * sum));
    }
    expect_crossings(
        &shapes::cube(),
        &sun(-3.0, -5.0, -7.5),
        &[([-3.0, -5.0, -7.25], 2), ([-3e6, -5e6, -7.5e6], 2)],
    );
    // In pictures: obliquely onto the wall, and away into the sky.
    let day = sun(-1.0, 0.0, -1.0);
    let scene = walled(&[plate([13.0, -2.0], [19.0, 2.0], 16.0)]);
    let must = |x: f32, y: f32| counted(x.abs() < 3.0 && y.abs() < 2.0, 1);
    expect_pixels("a slanting sun", &scene, &day, (0.5, 8.0), must);
    let sky = |x: f32, y: f32| if within(x, y, 4.0) { Pixel::Count(0) } else { Pixel::Sky };
    expect_pixels("a sun in the sky", &cover(2.0, 4.0), &day, (0.5, 8.0), sky);
    let Some(shot) = shoot(&scene, &sun(-1.25, 0.0, -1.0), &plain(), Some(StencilMethod::ZFail)) else {
        return;
    };
    assert!(!shot.wrong(8.0, must).is_empty(), "the sabotage: another sun");
}

/// Guards against clearing that depends on a light: without a light there is nothing to count.
#[test]
fn hard_20_zero_lights_and_zero_casters_leave_a_picture_lit() {
    let wall = walled(&[]);
    expect_pixels("a wall alone", &wall, &point(1.0, 2.0, 9.0), (0.5, 8.0), |_, _| Pixel::Count(0));
    let unlit = zero_lights(&wall);
    assert!(
        unlit.is_none_or(|mask| mask.raw().iter().all(|&count| count == 0) && mask.count(3, 4) == Some(0))
    );
    // A single triangle is enough to be seen.
    let scene = walled(&[plate([-20.0; 2], [20.0; 2], 16.0)]);
    let Some(shot) = shoot(&scene, &point(1.0, 2.0, 19.0), &plain(), Some(StencilMethod::ZFail)) else {
        return;
    };
    assert_eq!(shot.wrong(8.0, |_, _| Pixel::Count(0)).len(), 256, "the sabotage: a cover");
}
