//! What a function returns instead of its result.

use syn::{GenericArgument, PathArguments, Type};

/// Types of integers.
pub const INTEGERS: [&str; 12] =
    ["u8", "u16", "u32", "u64", "u128", "usize", "i8", "i16", "i32", "i64", "i128", "isize"];

/// Values of a type, as text; none where none is plain. What does not build is given up later.
pub fn of(kind: &Type) -> Vec<String> {
    let texts = |values: &[&str]| values.iter().map(|&value| value.to_owned()).collect();
    match kind {
        Type::Path(kind) => {
            let Some(last) = kind.path.segments.last() else { return Vec::new() };
            let name = last.ident.to_string();
            let inner = match &last.arguments {
                PathArguments::AngleBracketed(inner) => inner.args.first(),
                _ => None,
            };
            let inner = match inner {
                Some(GenericArgument::Type(inner)) => of(inner),
                _ => Vec::new(),
            };
            match name.as_str() {
                "bool" => texts(&["true", "false"]),
                "f32" | "f64" => texts(&["0.0", "1.0", "-1.0"]),
                "String" => texts(&["String::new()", "\"xyzzy\".into()"]),
                "Ordering" => texts(&["Ordering::Less", "Ordering::Equal", "Ordering::Greater"]),
                "Vec" => texts(&["Vec::new()"]),
                "Option" => {
                    let mut all = vec!["None".to_owned()];
                    all.extend(inner.iter().map(|value| format!("Some({value})")));
                    all
                }
                "Result" => inner.iter().map(|value| format!("Ok({value})")).collect(),
                "Box" => inner.iter().map(|value| format!("Box::new({value})")).collect(),
                integer if integer.starts_with('i') && INTEGERS.contains(&integer) => {
                    texts(&["0", "1", "-1"])
                }
                integer if INTEGERS.contains(&integer) => texts(&["0", "1"]),
                _ => texts(&["Default::default()"]),
            }
        }
        Type::Tuple(kind) if kind.elems.is_empty() => texts(&["()"]),
        // Each place in turn would be many: the first values of all.
        Type::Tuple(kind) => {
            let firsts =
                kind.elems.iter().map(|kind| of(kind).into_iter().next()).collect::<Option<Vec<_>>>();
            firsts.map(|firsts| format!("({},)", firsts.join(", "))).into_iter().collect()
        }
        Type::Array(kind) => {
            of(&kind.elem).into_iter().map(|value| format!("std::array::from_fn(|_| {value})")).collect()
        }
        Type::Reference(kind) => match &*kind.elem {
            Type::Slice(_) if kind.mutability.is_none() => texts(&["&[]"]),
            Type::Path(inner) if inner.path.is_ident("str") => texts(&["\"\"", "\"xyzzy\""]),
            _ => Vec::new(),
        },
        _ => Vec::new(),
    }
}
