#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| umbrage_fuzz::run("read_3mf", data));
