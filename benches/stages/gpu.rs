//! Sides, silhouettes and volumes on a graphics adapter, which the rows name.

use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::Light;
use umbrage::gpu::{Gpu, wgpu};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::shadow::volume::{Caps, GpuVolume, ShadowVolume, VolumeShaders};
use umbrage::silhouette::{GpuCaster, GpuSilhouette, Silhouette, SilhouetteShaders};
use umbrage::topology::{GpuTopology, Topology};

use crate::measure::{Bench, Contender, Group, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("gpu") {
        return;
    }
    let gpu = match Gpu::new(None) {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("SKIPPED, stage gpu: {error}");
            return;
        }
    };
    let shaders = SilhouetteShaders::new(&gpu).expect("they compile");
    let volumes = VolumeShaders::new(&gpu).expect("they compile");
    let light = Light::point([3.0, 4.0, 5.0]).expect("finite");
    facing(bench, &gpu, &shaders, &crate::ordered(bench.quick), &light);
    let mesh = crate::head(bench.quick);
    silhouette(bench, &gpu, &shaders, &volumes, &mesh, &light, "point light");
    let axis = Light::directional([0.0, 0.0, -1.0]).expect("not zero");
    silhouette(bench, &gpu, &shaders, &volumes, &crate::tied(bench.quick), &axis, "light along an axis");
}

fn facing(bench: &mut Bench<'_>, gpu: &Gpu, shaders: &SilhouetteShaders, mesh: &Mesh, light: &Light) {
    let topology = Topology::of(mesh);
    let caster = GpuCaster::new(shaders, mesh, GpuTopology::upload(gpu, &topology).expect("it fits"))
        .expect("it fits");
    let silhouette = GpuSilhouette::new(&caster).expect("it fits");
    let expected = classify(mesh, light);
    let plain = Plain::new(gpu, mesh, light);
    let contenders = vec![
        Contender::new("plain f32 shader", || {
            timed(|| submit(gpu, |encoder| plain.record(encoder)), |()| String::new())
        })
        .moves(16.0 + 1.0),
        Contender::new("GpuSilhouette::record_facing", || {
            timed(
                || submit(gpu, |encoder| silhouette.record_facing(encoder, light).expect("it fits")),
                |()| {
                    let found = silhouette.download_facing().expect("it is there");
                    let unsure = silhouette.download_unsure_count().expect("it is there");
                    let wrong = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
                    assert!(wrong <= unsure, "{wrong} sides are wrong, {unsure} unsure");
                    format!("unsure={unsure}")
                },
            )
        })
        .moves(20.0 + 1.0)
        .aims_at(Target::Ratio(1.5)),
        Contender::new("GpuSilhouette::classify", || {
            timed(
                || silhouette.classify(mesh, light).expect("it fits"),
                |unsure| {
                    assert!(silhouette.download_facing().expect("it is there") == expected, "other sides");
                    format!("unsure={unsure}")
                },
            )
        })
        .moves(20.0 + 1.0)
        .aims_at(Target::Time(5.0)),
    ];
    let name = format!("{} · {}", mesh.name, gpu.name()).replace(',', " ·");
    bench.run(Group {
        stage: "gpu facing",
        mesh: name,
        units: mesh.face_count(),
        unit: "triangle",
        contenders,
    });
}

fn silhouette(
    bench: &mut Bench<'_>,
    gpu: &Gpu,
    shaders: &SilhouetteShaders,
    volumes: &VolumeShaders,
    mesh: &Mesh,
    light: &Light,
    what: &str,
) {
    let planes = FacePlanes::new(mesh);
    let topology = Topology::of(mesh);
    let uploaded = GpuTopology::upload(gpu, &topology).expect("it fits");
    let caster = GpuCaster::with_planes(shaders, mesh, uploaded, &planes).expect("it fits");
    let device = GpuSilhouette::new(&caster).expect("it fits");
    let signs = CasterFaces::All.signs(&classify(mesh, light));
    let expected = Silhouette::extract(&topology, &signs);
    let count = format!("edges={}", expected.edges.len());
    let contenders = vec![
        Contender::new("FacePlanes and Silhouette::extract", || {
            timed(
                || Silhouette::extract(&topology, &CasterFaces::All.signs(&planes.classify(mesh, light))),
                |found| format!("edges={}", found.edges.len()),
            )
        })
        .expects(count.clone()),
        Contender::new("GpuSilhouette::find", || {
            timed(
                || device.find(mesh, light).expect("it fits"),
                |found| {
                    assert!(found.silhouette == expected, "another silhouette");
                    format!("edges={} unsure={}", found.silhouette.edges.len(), found.unsure_faces)
                },
            )
        })
        .aims_at(Target::Time(5e6 / mesh.face_count() as f64)),
        Contender::new("GpuSilhouette::record", || {
            timed(
                || submit(gpu, |encoder| device.record(encoder, light).expect("it fits")),
                |()| String::new(),
            )
        }),
    ];
    let name = format!("{} · {what} · {}", mesh.name, gpu.name()).replace(',', " ·");
    let (units, unit) = (mesh.face_count(), "triangle");
    bench.run(Group { stage: "gpu silhouette", mesh: name.clone(), units, unit, contenders });

    device.find(mesh, light).expect("it fits");
    let triangles =
        ShadowVolume::extrude(mesh, &topology, light, &signs, &expected, Caps::Both).triangles().len();
    let contenders = vec![
        Contender::new("ShadowVolume::extrude", || {
            timed(
                || ShadowVolume::extrude(mesh, &topology, light, &signs, &expected, Caps::Both),
                |volume| format!("triangles={}", volume.triangles().len()),
            )
        }),
        Contender::new("GpuVolume::extrude", || {
            timed(
                || {
                    let volume = GpuVolume::extrude(volumes, &device, light, Caps::Both).expect("it fits");
                    wait(gpu);
                    volume
                },
                |volume| {
                    assert!(volume.boundary_sum(gpu).expect("it is there").is_closed());
                    format!("triangles={}", volume.triangles.size() / 12)
                },
            )
        })
        .expects(format!("triangles={triangles}")),
    ];
    bench.run(Group { stage: "gpu volume", mesh: name, units, unit, contenders });
}

pub(crate) fn submit(gpu: &Gpu, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    record(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    wait(gpu);
}

pub(crate) fn wait(gpu: &Gpu) {
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
}

/// The simplest shader for the same layout: no filter, no list of unsure faces, and whatever sign `f32`
/// gives.
struct Plain {
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    workgroups: [u32; 2],
}

const PLAIN: &str = "
@group(0) @binding(0) var<uniform> l: vec4f;
@group(0) @binding(1) var<storage, read> planes: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> facing: array<u32>;
@compute @workgroup_size(64)
fn plain(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = global.y * groups.x * 64u + global.x;
    let count = arrayLength(&facing);
    if i >= count { return; }
    let s = planes[i] * l.x + planes[i + count] * l.y + planes[i + 2u * count] * l.z + planes[i + 3u * count] * l.w;
    let b = select(select(vec4u(0u), vec4u(0xffu), s < vec4f(0.0)), vec4u(1u), s > vec4f(0.0));
    facing[i] = b.x | (b.y << 8u) | (b.z << 16u) | (b.w << 24u);
}";

impl Plain {
    fn new(gpu: &Gpu, mesh: &Mesh, light: &Light) -> Self {
        let groups = mesh.face_count().div_ceil(4);
        let mut planes = vec![0.0_f32; 16 * groups];
        for face in 0..mesh.face_count() {
            let [a, b, c] = mesh.corners(FaceId::new(face));
            let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let d = -(n[0] * a[0] + n[1] * a[1] + n[2] * a[2]);
            for (k, value) in [n[0], n[1], n[2], d].into_iter().enumerate() {
                planes[4 * (k * groups + face / 4) + face % 4] = value;
            }
        }
        let device = gpu.device();
        let buffer = |size: u64, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let bytes = |values: &[f32]| values.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>();
        let uniform = buffer(16, wgpu::BufferUsages::UNIFORM);
        let stored = buffer(4 * planes.len() as u64, wgpu::BufferUsages::STORAGE);
        let facing = buffer(4 * groups as u64, wgpu::BufferUsages::STORAGE);
        gpu.queue().write_buffer(&uniform, 0, &bytes(&light.homogeneous()));
        gpu.queue().write_buffer(&stored, 0, &bytes(&planes));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(PLAIN.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("plain"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: stored.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: facing.as_entire_binding() },
            ],
        });
        let all = groups.div_ceil(64) as u32;
        let y = all.div_ceil(65_535);
        Self { pipeline, bindings, workgroups: [all.div_ceil(y.max(1)), y] }
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
    }
}
