#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    meniscus_fuzz::scene(bytes);
});
