// Exclusive prefix sums of `values`, RUN values per invocation. Twin: prefix_sum.rs. First every run is added
// up (`sum_runs`), then the sums are scanned in the same way, then every run is added up again from the sum
// before it (`spread`). No barriers and no atomics: the result has one possible value.

@group(0) @binding(0) var<storage, read_write> values: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;
// x: the number of values.
@group(0) @binding(2) var<uniform> count: vec4u;

@compute @workgroup_size(WORKGROUP)
fn sum_runs(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    let start = run * RUN;
    if start >= count.x { return; }
    let end = min(start + RUN, count.x);
    var sum = 0u;
    for (var i = start; i < end; i++) { sum += values[i]; }
    sums[run] = sum;
}

@compute @workgroup_size(WORKGROUP)
fn spread(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    let start = run * RUN;
    if start >= count.x { return; }
    let end = min(start + RUN, count.x);
    var sum = sums[run];
    for (var i = start; i < end; i++) {
        let value = values[i];
        values[i] = sum;
        sum += value;
    }
    // The total comes after the values.
    if end == count.x { values[end] = sum; }
}

// One run alone: nothing comes before it.
@compute @workgroup_size(1)
fn spread_one() {
    var sum = 0u;
    for (var i = 0u; i < count.x; i++) {
        let value = values[i];
        values[i] = sum;
        sum += value;
    }
    values[count.x] = sum;
}
