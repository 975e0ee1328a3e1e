//! Where a file can be changed, and into what: one walk over its syntax tree.

use std::ops::Range;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, UnOp};

use crate::defaults;

/// A place of a file that is changed in one of several ways.
pub struct Point {
    /// The bytes that change.
    pub at: Range<usize>,
    pub line: usize,
    pub column: usize,
    pub function: String,
    pub form: Form,
    pub changes: Vec<Change>,
}

/// What a point is in the syntax.
#[derive(Clone, Copy, PartialEq)]
pub enum Form {
    /// An expression: another one stands for it.
    Expression,
    /// The first statement of a body: an earlier return.
    Body,
    /// The pattern of a match arm: the arm never matches.
    Arm,
}

/// One mutant.
#[derive(Clone)]
pub struct Change {
    /// The text that stands there instead.
    pub text: String,
    /// `< to <=`.
    pub name: String,
}

/// A constant, and what its uses become.
pub struct Constant {
    pub name: String,
    pub line: usize,
    pub column: usize,
    pub changes: Vec<Change>,
}

/// What a file holds.
pub struct Found {
    pub points: Vec<Point>,
    pub constants: Vec<Constant>,
    /// Expressions that name a constant in capitals, by its last segment.
    pub uses: Vec<(String, Point)>,
    /// How often each named mutant was found.
    pub named: Vec<usize>,
}

/// Walks over `source`; `named` holds pairs of an expression and what stands for it.
pub fn find(source: &str, named: &[(String, String)]) -> syn::Result<Found> {
    let file = syn::parse_file(source)?;
    let found =
        Found { points: Vec::new(), constants: Vec::new(), uses: Vec::new(), named: vec![0; named.len()] };
    let mut walk = Walk { source, named, found, names: Vec::new() };
    walk.visit_file(&file);
    Ok(walk.found)
}

struct Walk<'a> {
    source: &'a str,
    named: &'a [(String, String)],
    found: Found,
    names: Vec<String>,
}

/// Conditions under which code is not in the tested build, or is a test.
fn is_left_out(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let text = match &attribute.meta {
            syn::Meta::List(list) => format!("{} {}", path(&list.path), list.tokens),
            meta => path(meta.path()),
        };
        text == "test"
            || text.starts_with("cfg ")
                && (text.contains("test") && !text.contains("not")
                    || ["\"gpu\"", "\"parallel\"", "\"cli\"", "\"draco\""]
                        .iter()
                        .any(|one| text.contains(one)))
    })
}

fn path(path: &syn::Path) -> String {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect::<Vec<_>>().join("::")
}

impl Walk<'_> {
    fn text(&self, part: &impl Spanned) -> &str {
        &self.source[part.span().byte_range()]
    }

    fn point(&self, part: &impl Spanned, form: Form, changes: Vec<Change>) -> Point {
        let span = part.span();
        let start = span.start();
        let function = self.names.join("::");
        Point { at: span.byte_range(), line: start.line, column: start.column + 1, function, form, changes }
    }

    /// An expression that becomes another one; names end with its text.
    fn expression(&mut self, part: &Expr, changes: Vec<(String, String)>) {
        let snippet = snippet(self.text(part));
        let changes = changes
            .into_iter()
            .map(|(name, text)| Change { text, name: format!("{name}: {snippet}") })
            .collect::<Vec<_>>();
        if !changes.is_empty() {
            let point = self.point(part, Form::Expression, changes);
            self.found.points.push(point);
        }
    }

    fn binary(&mut self, part: &Expr, binary: &syn::ExprBinary) {
        let (left, right) = (self.text(&*binary.left).to_owned(), self.text(&*binary.right).to_owned());
        let operator = self.text(&binary.op).to_owned();
        // An `if let` chain is no expression by itself.
        if matches!(binary.op, BinOp::And(_)) && has_let(part) {
            return;
        }
        let changes = others(&binary.op)
            .iter()
            .map(|other| (format!("{operator} to {other}"), format!("{left} {other} {right}")))
            .collect();
        self.expression(part, changes);
    }

    fn body(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let returns = match &signature.output {
            syn::ReturnType::Default if block.stmts.is_empty() => Vec::new(),
            syn::ReturnType::Default => vec![String::new()],
            syn::ReturnType::Type(_, of) => defaults::of(of),
        };
        let whole = self.text(block).trim_start_matches('{').trim_end_matches('}').trim().to_owned();
        let changes = returns
            .into_iter()
            .filter(|value| *value != whole)
            .map(|value| Change { text: format!("return {value}"), name: format!("body to `{value}`") })
            .collect::<Vec<_>>();
        if !changes.is_empty() {
            let mut point = self.point(block, Form::Body, changes);
            point.at = point.at.start + 1..point.at.start + 1;
            self.found.points.push(point);
        }
    }

    fn function(&mut self, attributes: &[syn::Attribute], signature: &syn::Signature, block: &syn::Block) {
        if signature.constness.is_some() || is_left_out(attributes) {
            return;
        }
        self.names.push(signature.ident.to_string());
        let is_debug = signature.ident == "fmt" && self.names.iter().any(|name| name.ends_with("Debug"));
        if !is_debug {
            self.body(signature, block);
        }
        self.visit_block(block);
        self.names.pop();
    }

    fn constant(&mut self, name: &syn::Ident, of: &syn::Type) {
        let kind = self.text(of).to_owned();
        let text = |pattern: &str| (pattern.to_owned(), format!("({})", pattern));
        let changes = if defaults::INTEGERS.contains(&kind.as_str()) {
            vec![text("@.wrapping_add(1)"), text("@.wrapping_sub(1)")]
        } else if matches!(kind.as_str(), "f32" | "f64") {
            vec![text("@ * 2.0"), text("@ / 2.0"), text("0.0"), text("1.0")]
        } else if kind == "bool" {
            vec![text("!@")]
        } else {
            return;
        };
        let start = name.span().start();
        let changes = changes
            .into_iter()
            .map(|(change, text)| Change {
                text,
                name: format!("constant to {}: {name}", change.replace('@', "it")),
            })
            .collect();
        let name = name.to_string();
        self.found.constants.push(Constant { name, line: start.line, column: start.column + 1, changes });
    }

    fn condition(&mut self, condition: &Expr) {
        let is_mutated = matches!(condition, Expr::Binary(_) | Expr::Unary(_) | Expr::Let(_) | Expr::Lit(_));
        if !is_mutated {
            let text = format!("!({})", self.text(condition));
            self.expression(condition, vec![("condition to its opposite".into(), text)]);
        }
    }
}

/// The text of an expression in one line, not too long.
fn snippet(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(70) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words,
    }
}

fn has_let(part: &Expr) -> bool {
    match part {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

/// The operators that stand for one.
fn others(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["*", "%"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::BitXor(_) => &["|", "&"],
        BinOp::BitAnd(_) => &["|", "^"],
        BinOp::BitOr(_) => &["&", "^"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::Lt(_) => &["<=", ">"],
        BinOp::Le(_) => &["<", ">"],
        BinOp::Gt(_) => &[">=", "<"],
        BinOp::Ge(_) => &[">", "<"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) => &["+=", "/="],
        BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["*=", "%="],
        BinOp::RemAssign(_) => &["/=", "+="],
        BinOp::BitXorAssign(_) => &["|=", "&="],
        BinOp::BitAndAssign(_) => &["|=", "^="],
        BinOp::BitOrAssign(_) => &["&=", "^="],
        BinOp::ShlAssign(_) => &[">>="],
        BinOp::ShrAssign(_) => &["<<="],
        _ => &[],
    }
}

fn attributes(part: &Expr) -> &[syn::Attribute] {
    match part {
        Expr::Block(one) => &one.attrs,
        Expr::If(one) => &one.attrs,
        Expr::Return(one) => &one.attrs,
        Expr::Match(one) => &one.attrs,
        Expr::Call(one) => &one.attrs,
        Expr::MethodCall(one) => &one.attrs,
        Expr::Assign(one) => &one.attrs,
        Expr::ForLoop(one) => &one.attrs,
        Expr::Closure(one) => &one.attrs,
        _ => &[],
    }
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_expr(&mut self, part: &'ast Expr) {
        if is_left_out(attributes(part)) {
            return;
        }
        for index in 0..self.named.len() {
            let (from, to) = &self.named[index];
            if self.text(part) == from {
                self.found.named[index] += 1;
                self.expression(part, vec![(format!("to {to}"), to.clone())]);
            }
        }
        match part {
            Expr::Binary(binary) => self.binary(part, binary),
            // A negative literal is a constant.
            Expr::Unary(unary)
                if matches!(unary.op, UnOp::Not(_) | UnOp::Neg(_))
                    && !matches!(*unary.expr, Expr::Lit(_)) =>
            {
                let text = self.text(&*unary.expr).to_owned();
                self.expression(part, vec![(format!("without {}", self.text(&unary.op)), text)]);
            }
            Expr::If(one) => self.condition(&one.cond),
            Expr::While(one) => self.condition(&one.cond),
            Expr::Match(one) => {
                let ends_in_rest = one.arms.last().is_some_and(|arm| {
                    let is_rest = match &arm.pat {
                        syn::Pat::Wild(_) => true,
                        // A name in lower case is a variable; others are variants and constants.
                        syn::Pat::Ident(name) => name.ident.to_string().starts_with(char::is_lowercase),
                        _ => false,
                    };
                    is_rest && arm.guard.is_none()
                });
                if ends_in_rest {
                    for arm in &one.arms[..one.arms.len() - 1] {
                        if arm.guard.is_none() && !is_left_out(&arm.attrs) {
                            let name = format!("without the arm: {}", snippet(self.text(&arm.pat)));
                            let change = Change { text: String::new(), name };
                            let mut point = self.point(&arm.pat, Form::Arm, vec![change]);
                            point.at = point.at.end..point.at.end;
                            self.found.points.push(point);
                        }
                    }
                }
            }
            Expr::Path(one) => {
                let name =
                    one.path.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default();
                if name.len() > 1 && !name.contains(|letter: char| letter.is_lowercase()) {
                    let point = self.point(part, Form::Expression, Vec::new());
                    self.found.uses.push((name, point));
                }
            }
            _ => {}
        }
        visit::visit_expr(self, part);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        if is_left_out(&arm.attrs) {
            return;
        }
        if let Some((_, guard)) = &arm.guard {
            if !has_let(guard) {
                let changes = ["true", "false"].map(|value| (format!("guard to {value}"), value.to_owned()));
                self.expression(guard, changes.into());
            }
            self.visit_expr(guard);
        }
        self.visit_expr(&arm.body);
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.attrs, &item.sig, &item.block);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.attrs, &item.sig, &item.block);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.attrs, &item.sig, block);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if is_left_out(&item.attrs) {
            return;
        }
        let of = self.text(&*item.self_ty).split('<').next().unwrap_or_default().to_owned();
        let name = match &item.trait_ {
            Some((_, name, _)) => format!("{of} as {}", path(name)),
            None => of,
        };
        self.names.push(name);
        visit::visit_item_impl(self, item);
        self.names.pop();
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_left_out(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        if !is_left_out(&item.attrs) {
            self.constant(&item.ident, &item.ty);
        }
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        if !is_left_out(&item.attrs) {
            self.constant(&item.ident, &item.ty);
        }
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        if !is_left_out(&local.attrs) {
            visit::visit_local(self, local);
        }
    }

    fn visit_field_value(&mut self, field: &'ast syn::FieldValue) {
        // A field named alone has no room for an expression.
        if field.colon_token.is_some() && !is_left_out(&field.attrs) {
            visit::visit_field_value(self, field);
        }
    }

    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    // Computed by the compiler: no choice at run time.
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_item_enum(&mut self, _: &'ast syn::ItemEnum) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_macro(&mut self, _: &'ast syn::Macro) {}
}
