// One digit of a stable radix sort of pairs (key, value), RUN pairs per invocation. Twin: sort.rs. First
// every run counts its digits (`count_digits`). A prefix sum over all counts, digit by digit and within a
// digit run by run, turns them into positions. Then every run is read again in the same order, and each pair
// is written to the next position of its digit and run (`scatter`). No barriers and no atomics: the result
// has one possible value.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read> values: array<u32>;
// Counts, then positions: of digit d and run r at d * runs + r.
@group(0) @binding(2) var<storage, read_write> positions: array<u32>;
@group(0) @binding(3) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> sorted_values: array<u32>;
@group(0) @binding(5) var<uniform> digit: Digit;

struct Digit {
    // The number of pairs.
    count: u32,
    // The number of runs.
    runs: u32,
    // The digit's lowest bit.
    shift: u32,
    // Its largest value, all ones, below DIGITS.
    largest: u32,
}

@compute @workgroup_size(WORKGROUP)
fn count_digits(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    if run >= digit.runs { return; }
    let start = run * RUN;
    let length = min(RUN, digit.count - start);
    var counts: array<u32, DIGITS>;
    for (var step = 0u; step < length; step++) {
        counts[(keys[start + step] >> digit.shift) & digit.largest]++;
    }
    for (var d = 0u; d <= digit.largest; d++) { positions[d * digit.runs + run] = counts[d]; }
}

@compute @workgroup_size(WORKGROUP)
fn scatter(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    if run >= digit.runs { return; }
    let start = run * RUN;
    let length = min(RUN, digit.count - start);
    for (var step = 0u; step < length; step++) {
        let i = start + step;
        let key = keys[i];
        let counter = ((key >> digit.shift) & digit.largest) * digit.runs + run;
        let position = positions[counter];
        positions[counter] = position + 1u;
        sorted_keys[position] = key;
        sorted_values[position] = values[i];
    }
}
