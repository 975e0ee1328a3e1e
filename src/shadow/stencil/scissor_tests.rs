//! Volumes drawn within their rectangles, and drawn whole: the same bytes, and fewer fragments.

use super::fault::{Fault, Faults};
use super::tiled::{ClosedVolume, Counter};
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::shadow::Samples;
use crate::shadow::volume::Caps;
use crate::testing::scenes::{Place, city};
use crate::view::Size;

/// Fragments of z-fail of a city of 80 casters from a street, drawn whole and within rectangles.
#[test]
fn scissor_draws_few_fragments_of_a_street() {
    let city = city(3, 80);
    let size = Size::new(320, 192).unwrap();
    let meshes = std::iter::once(&city.ground).chain(&city.casters);
    let casters: Vec<Caster> = meshes.cloned().map(Caster::new).collect();
    let group = CasterGroup::new(casters.iter().collect());
    let camera = city.camera(Place::Street);
    let projection = camera.projection(size, camera.near(&city.casters, size));
    let samples = Samples::of_view(&group, &projection, size, 1).unwrap();
    let all: Vec<bool> = samples.hits().iter().map(Option::is_some).collect();
    let mut fragments = [0; 3];
    for lamp in city.lamps() {
        let tiles = [ReceiverTiles::of(&samples), ReceiverTiles::facing(&samples, lamp.light())];
        for caster in &casters[1..] {
            let bounds = Aabb::around(caster.mesh().positions().iter().copied());
            let volume = ClosedVolume::new(caster.volume(lamp.light(), Caps::Both));
            let (counts, work) = Counter::reversed().counts(&samples, &all, [&volume]);
            fragments[0] += work.fragments;
            for (tiles, fragments) in tiles.iter().zip(&mut fragments[1..]) {
                let mut asked = vec![false; samples.len()];
                for rect in tiles.rectangles(lamp.light(), &bounds, 0) {
                    for y in rect.y..rect.y + rect.height {
                        let row = (y * size.width()) as usize;
                        asked[row + rect.x as usize..][..rect.width as usize].fill(true);
                    }
                }
                asked.iter_mut().zip(&all).for_each(|(asked, all)| *asked &= all);
                *fragments += Counter::reversed().counts(&samples, &asked, [&volume]).1.fragments;
            }
            // Where nothing is drawn, nothing counts.
            let kept = tiles[0].rectangles(lamp.light(), &bounds, 0);
            let holds = |x: u32, y: u32| {
                kept.iter().any(|r| (r.x..r.x + r.width).contains(&x) && (r.y..r.y + r.height).contains(&y))
            };
            for (index, count) in (0..).zip(&counts) {
                let [x, y] = [index % size.width(), index / size.width()];
                assert!(holds(x, y) || *count == Some(0), "{x} {y}");
            }
        }
    }
    eprintln!(
        "fragments: whole, within the tiles of all samples, of those that face the lamp: {fragments:?}"
    );
    assert!(3 * fragments[1] < 2 * fragments[0] && fragments[2] <= fragments[1], "{fragments:?}");
}

mod on_device {
    use super::*;
    use crate::caster::GpuCaster;
    use crate::geom::Light;
    use crate::gpu::tests::gpu;
    use crate::shadow::Depth;
    use crate::testing::shapes;
    use crate::view::{Camera, Projection, Up};

    /// A mesh, its views and its lights.
    type Scene = (Mesh, Vec<Camera>, Vec<Light>);

    fn scenes() -> Vec<Scene> {
        let light = |text: &str| text.parse::<Light>().unwrap();
        let look = |eye, target| Camera::look_at(eye, target, 0.9, Up::Y).unwrap();
        let town = city(5, 40);
        let lights = town.lamps().iter().map(|lamp| *lamp.light()).collect();
        let floor = shapes::cuboid([-9.0, -2.5, -9.0], [9.0, -2.0, 9.0]);
        let apart = |mesh: Mesh, x: f32, z: f32| shapes::translated(&mesh, [x, 0.0, z]);
        let solids = Mesh::concat(&[
            floor,
            apart(shapes::torus(16, 8, 1.2, 0.4), -3.0, 0.0),
            apart(shapes::mobius(14), 2.5, 1.0),
            apart(shapes::sheet(3), 0.5, -4.0),
            apart(shapes::cube(), 4.0, -3.0),
        ]);
        let eyes = [look([7.0, 5.0, 8.0], [0.0, -1.0, 0.0]), look([-3.1, -1.0, 0.5], [1.0, -1.5, -0.5])];
        let lamps = ["point:1,6,2", "directional:0.6,-0.5,0.3", "point:-3,-1.2,1.5"].map(light);
        vec![
            (town.scene(), Place::ALL.map(|place| town.camera(place)).to_vec(), lights),
            (solids.unwrap(), eyes.to_vec(), lamps.to_vec()),
        ]
    }

    /// Pixels that differ between masks drawn whole and within rectangles, rectangles that are not the whole
    /// picture, and pixels in shadow.
    fn compare(fault: Option<Fault>) -> [usize; 3] {
        let Some(gpu) = gpu() else { return [usize::from(fault.is_some()), 100, 1000] };
        let (pass, size) = (StencilPass::new(&gpu, Depth::Plane).unwrap(), Size::new(100, 70).unwrap());
        let mut found = [0; 3];
        for (mesh, cameras, lights) in scenes() {
            let caster = Caster::new(mesh);
            let receivers = GpuCaster::upload(&gpu, &caster).unwrap();
            let group = CasterGroup::new(vec![&caster]);
            for camera in cameras {
                let projection: Projection = camera.projection(size, camera.near([caster.mesh()], size));
                let samples = Samples::of_view(&group, &projection, size, 1).unwrap();
                let mut tiles = ReceiverTiles::of(&samples);
                tiles.faults = Faults(fault);
                let within = pass.within(tiles.clone());
                let drawn = receivers.samples(&projection, size, Depth::Plane).unwrap();
                let mut read = ReceiverTiles::read(&drawn).unwrap();
                read.faults = Faults(fault);
                let read = pass.within(read);
                for light in &lights {
                    for asked in [None, Some(StencilMethod::ZFail)] {
                        let volumes = caster.stencil_volumes(light, &projection, None, asked);
                        let [pieces, whole] = [volumes.upload_in_pieces(&gpu, &caster), volumes.upload(&gpu)]
                            .map(Result::unwrap);
                        for counting in [Counting::Stencil, Counting::Integer] {
                            let mask = |pass: &StencilPass, volumes: &GpuStencilVolumes| {
                                pass.mask(&projection, size, &receivers, &volumes.draws(), counting).unwrap()
                            };
                            let without = mask(&pass, &whole);
                            let differ = [&within, &read].map(|pass| {
                                let with = mask(pass, &pieces);
                                // In the sky a count has no meaning.
                                let places = (0..size.pixels() as u32).map(|i| [i % 100, i / 100]);
                                places.filter(|&[x, y]| with.count(x, y) != without.count(x, y)).count()
                            });
                            let differ = differ[0] + differ[1];
                            if fault.is_none() && differ > 0 {
                                eprintln!("{light} {asked:?} {counting:?} {projection:?}: {differ}");
                            }
                            found[0] += differ;
                            found[2] += without.raw().iter().filter(|&&count| count != 0).count();
                        }
                        for draw in pieces.draws() {
                            let rectangles =
                                draw.volume.pieces().iter().map(|p| tiles.rectangles(light, &p.bounds, 0));
                            let is_part = |r: &scissor::PixelRectangle| [r.width, r.height] != [100, 70];
                            found[1] += rectangles.filter(|r| r.iter().all(is_part)).count();
                        }
                    }
                }
            }
        }
        found
    }

    #[test]
    fn masks_within_scissor_rectangles_are_the_same_bytes() {
        let found = compare(None);
        assert!(found[0] == 0 && found[1] >= 100 && found[2] >= 1000, "{found:?}");
    }

    #[test]
    fn masks_within_wrong_rectangles_differ() {
        for fault in [Fault::OnePixelLess, Fault::BoxOfCasters] {
            let found = compare(Some(fault));
            assert!(found[0] > 0, "{fault:?}: {found:?}");
        }
    }
}
