//! The edge table on the device: built on the host and copied, or built on the device.

use umbrage::gpu::{Gpu, GpuError, wgpu};
use umbrage::mesh::Mesh;
use umbrage::topology::{GpuTopology, GpuTopologyBuilder, Topology};

use crate::measure::{Bench, Contender, Group, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("edge table on the device") {
        return;
    }
    let meshes = [crate::ordered(bench.quick), crate::scattered(bench.quick)];
    let all = |gpu: Gpu| meshes.iter().try_for_each(|mesh| edge_table(bench, &gpu, mesh));
    if let Err(error) = Gpu::new(None).and_then(all) {
        eprintln!("SKIPPED, edge table on the device: {error}");
    }
}

fn edge_table(bench: &mut Bench<'_>, gpu: &Gpu, mesh: &Mesh) -> Result<(), GpuError> {
    let on_host = || Topology::of(mesh);
    let sent = GpuTopology::upload(gpu, &on_host())?;
    let expected = sent.download(gpu)?;
    let builder = GpuTopologyBuilder::new(gpu)?;
    // A device failure stops the bench, as a wrong answer does.
    let finished = |topology: Result<GpuTopology, GpuError>| {
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).map(|_| topology).map_err(|e| e.to_string())
    };
    let answer = |topology: &Result<Result<GpuTopology, GpuError>, String>| match topology {
        Ok(Ok(topology)) => format!("same_words={}", topology.download(gpu).as_ref() == Ok(&expected)),
        Ok(Err(error)) => error.to_string(),
        Err(error) => error.clone(),
    };
    let contenders = vec![
        Contender::new("Topology::build and upload", || {
            timed(|| finished(GpuTopology::upload(gpu, &on_host())), answer)
        })
        .expects("same_words=true"),
        Contender::new("GpuTopologyBuilder::build", || {
            let build = || builder.build(gpu, sent.vertex_count, &sent.triangles, sent.face_count);
            timed(|| finished(build()), answer)
        })
        .expects("same_words=true"),
    ];
    let mesh = format!("{} on {}", mesh.name, gpu.name().replace(',', ";")); // no comma within a cell
    let units = sent.face_count as usize;
    bench.run(Group { stage: "edge table on the device", mesh, units, unit: "triangle", contenders });
    Ok(())
}
