//! A check that a structure has the same layout in Rust and in WGSL.

/// Asserts that a WGSL structure has the size of a Rust one, and its members the same names and offsets.
macro_rules! assert_layout {
    ($source:expr, $name:expr, $of:ident: $($field:ident),* $(,)?) => {{
        let rust = [$((stringify!($field).to_owned(), std::mem::offset_of!($of, $field))),*];
        assert_eq!($crate::gpu::layout::members($source, $name), (rust.to_vec(), size_of::<$of>()), "{}", $name);
    }};
}

pub(crate) use assert_layout;

/// The members of a WGSL structure with their offsets, and its size without an array of unknown length.
pub(crate) fn members(source: &str, name: &str) -> (Vec<(String, usize)>, usize) {
    let module = naga::front::wgsl::parse_str(source).expect("the shader is valid");
    let found = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = found else {
        panic!("{name} is a structure");
    };
    let offset = |member: &naga::StructMember| (member.name.clone().expect("named"), member.offset as usize);
    (members.iter().map(offset).collect(), *span as usize)
}

#[test]
fn layout_that_differs_is_caught() {
    #[allow(dead_code, reason = "only its layout is asked for")]
    #[repr(C)]
    struct Sizes {
        a: [f32; 3],
        b: u32,
    }
    let check = |wgsl: &'static str| std::panic::catch_unwind(|| assert_layout!(wgsl, "Sizes", Sizes: a, b));
    assert!(check("struct Sizes { a: vec3f, b: u32 }").is_ok());
    // A vector of three is aligned to 16 bytes.
    assert!(check("struct Sizes { b: u32, a: vec3f }").is_err());
    assert!(check("struct Sizes { a: vec3f, c: u32 }").is_err());
    assert!(check("struct Sizes { a: vec3f, b: u32, c: u32 }").is_err());
}
