//! The text of a file with changes behind switches.

use std::collections::HashMap;
use std::ops::Range;

use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Arm, BinOp, Block, Expr, ExprBinary, ExprUnary, Signature};

use crate::Failure;
use crate::mutant::Mutant;

/// A file with its changes.
pub struct Switched {
    /// The text to compile.
    pub text: String,
    /// Where each place of change is in it, with the numbers of its changes: a place in another one stands behind it.
    pub places: Vec<(Range<usize>, Vec<usize>)>,
}

impl Switched {
    /// A source with those of `mutants` that are `wanted`. A change that cannot be switched is in no place.
    pub fn of(source: &str, mutants: &[(usize, &Mutant)]) -> Result<Self, Failure> {
        let mut at = Changes::new();
        for (id, mutant) in mutants {
            let key = (mutant.span.start.line, mutant.span.start.column, mutant.genre.as_str());
            at.entry(key).or_default().push((*id, &mutant.replacement));
        }
        let mut finder = Finder { at, edits: Vec::new() };
        finder.visit_file(&syn::parse_file(source)?);
        let mut edits = finder.edits;
        // What contains another edit stands before it, and what is inserted, before what is replaced there.
        edits.sort_by_key(|edit| {
            (edit.range.start, !edit.range.is_empty(), usize::MAX - edit.range.end)
        });
        let mut switched = Self { text: String::new(), places: Vec::new() };
        switched.write(source, &edits, 0, 0..source.len());
        Ok(switched)
    }

    /// Writes a part of the source with the edits from one on that lie in it.
    fn write(&mut self, source: &str, edits: &[Edit], from: usize, range: Range<usize>) {
        let mut written = range.start;
        for (i, edit) in edits.iter().enumerate().skip(from) {
            if edit.range.start < written || edit.range.end > range.end {
                continue;
            }
            self.text.push_str(&source[written..edit.range.start]);
            let (begin, place) = (self.text.len(), self.places.len());
            self.places.push((begin..begin, edit.ids.clone()));
            for piece in &edit.pieces {
                match piece {
                    Piece::Text(text) => self.text.push_str(text),
                    Piece::Source(part) => self.write(source, edits, i + 1, part.clone()),
                }
            }
            self.places[place].0.end = self.text.len();
            written = edit.range.end;
        }
        self.text.push_str(&source[written..range.end]);
    }

    /// The changes that a compiler's complaint about a part of the text speaks of: those of the innermost place there, the one whose
    /// switch stands last before it where there is one, else those of the place that is nearest.
    pub fn blamed(&self, error: Range<usize>) -> Vec<usize> {
        let around = self
            .places
            .iter()
            .filter(|(range, _)| range.start <= error.start && error.start < range.end);
        let Some((range, ids)) = around.min_by_key(|(range, _)| range.len()) else {
            let distance = |range: &Range<usize>| {
                range.start.abs_diff(error.start).min(range.end.abs_diff(error.start))
            };
            let inside =
                |range: &Range<usize>| error.start <= range.start && range.end <= error.end;
            let nearest =
                self.places.iter().min_by_key(|(range, _)| (!inside(range), distance(range)));
            return nearest.map(|(_, ids)| ids.clone()).unwrap_or_default();
        };
        let before = &self.text[range.start..error.end.min(range.end)];
        let last = ids.iter().filter_map(|id| Some((before.rfind(&switch(*id))?, *id))).max();
        last.map_or_else(|| ids.clone(), |(_, id)| vec![id])
    }
}

/// A part of the source, and what stands there instead.
struct Edit {
    range: Range<usize>,
    ids: Vec<usize>,
    pieces: Vec<Piece>,
}

/// A text, or a part of the source with its own edits.
enum Piece {
    Text(String),
    Source(Range<usize>),
}

/// The condition that a change is on.
fn switch(id: usize) -> String {
    format!("::mutant_switch::on({id})")
}

/// Numbers and replacements by line, column and kind.
type Changes<'a> = HashMap<(usize, usize, &'a str), Vec<(usize, &'a str)>>;

/// Finds the places of changes.
struct Finder<'a> {
    at: Changes<'a>,
    edits: Vec<Edit>,
}

impl Finder<'_> {
    /// The changes of a kind that begin where a span does.
    fn take(&mut self, span: Span, genre: &'static str) -> Vec<(usize, String)> {
        let start = span.start();
        let found = self.at.get(&(start.line, start.column + 1, genre));
        found.into_iter().flatten().map(|(id, text)| (*id, (*text).to_owned())).collect()
    }

    fn edit(&mut self, range: Range<usize>, changes: &[(usize, String)], pieces: Vec<Piece>) {
        self.edits.push(Edit { range, ids: changes.iter().map(|(id, _)| *id).collect(), pieces });
    }

    /// A function returns another value at once.
    fn function(&mut self, signature: &Signature, block: &Block) {
        let (Some(first), None) = (block.stmts.first(), signature.constness) else { return };
        let changes = self.take(first.span(), "FnValue");
        if changes.is_empty() {
            return;
        }
        let text = changes
            .iter()
            .map(|(id, value)| format!("if {} {{ return {value}; }} ", switch(*id)))
            .collect();
        let start = first.span().byte_range().start;
        self.edit(start..start, &changes, vec![Piece::Text(text)]);
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block);
        if item.sig.constness.is_none() {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block);
        if item.sig.constness.is_none() {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
        visit::visit_trait_item_fn(self, item);
    }

    fn visit_expr_binary(&mut self, binary: &'ast ExprBinary) {
        let changes = self.take(binary.op.span(), "BinaryOperator");
        let (left, right) = (binary.left.span().byte_range(), binary.right.span().byte_range());
        let around = binary.span().byte_range();
        let lazy = matches!(binary.op, BinOp::And(_) | BinOp::Or(_));
        if !changes.is_empty() && !(lazy && (has_let(&binary.left) || has_let(&binary.right))) {
            let pieces = binary_pieces(&binary.op, left, right, &changes);
            self.edit(around, &changes, pieces);
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast ExprUnary) {
        let changes = self.take(unary.op.span(), "UnaryOperator");
        if let [(id, _)] = changes.as_slice() {
            let sign = quote(&unary.op);
            let chosen = format!(
                " {{ v_{id} => if {} {{ v_{id} }} else {{ {sign}v_{id} }} }})",
                switch(*id)
            );
            let operand = Piece::Source(unary.expr.span().byte_range());
            let pieces = vec![Piece::Text("(match ".to_owned()), operand, Piece::Text(chosen)];
            self.edit(unary.span().byte_range(), &changes, pieces);
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_arm(&mut self, arm: &'ast Arm) {
        let gone = self.take(arm.span(), "MatchArm");
        let without: String = gone.iter().map(|(id, _)| format!("!{}", switch(*id))).collect();
        match &arm.guard {
            Some((_, guard)) if !has_let(guard) => {
                let mut changes = self.take(guard.span(), "MatchArmGuard");
                let mut pieces = vec![Piece::Text("(".to_owned())];
                for (id, value) in &changes {
                    let (not, join) = if value == "true" { ("", "||") } else { ("!", "&&") };
                    pieces.push(Piece::Text(format!("{not}{} {join} (", switch(*id))));
                }
                pieces.push(Piece::Source(guard.span().byte_range()));
                pieces.push(Piece::Text(")".repeat(changes.len() + 1)));
                if !without.is_empty() {
                    pieces.push(Piece::Text(format!(" && {without}")));
                }
                changes.extend(gone);
                if !changes.is_empty() {
                    self.edit(guard.span().byte_range(), &changes, pieces);
                }
            }
            None if !gone.is_empty() => {
                let arrow = arm.fat_arrow_token.spans[0].byte_range().start;
                self.edit(arrow..arrow, &gone, vec![Piece::Text(format!("if {without} "))]);
            }
            _ => {}
        }
        visit::visit_arm(self, arm);
    }

    // What is computed when it is compiled cannot be switched when it runs.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
}

/// Both operands are evaluated once, as they were, but for `&&` and `||`, whose second operand is evaluated where it was or would be.
fn binary_pieces(
    op: &BinOp,
    left: Range<usize>,
    right: Range<usize>,
    changes: &[(usize, String)],
) -> Vec<Piece> {
    use Piece::{Source, Text};
    let first = changes[0].0;
    let (l, r) = (format!("l_{first}"), format!("r_{first}"));
    let sign = quote(op);
    match op {
        BinOp::And(_) | BinOp::Or(_) => {
            let goes_on = matches!(op, BinOp::And(_));
            let condition = format!("{{ {l} => if ({l} == {goes_on}) ^ {} {{ ", switch(first));
            vec![
                Text("(match ".to_owned()),
                Source(left),
                Text(format!(" {condition}")),
                Source(right),
                Text(format!(" }} else {{ {l} }} }})")),
            ]
        }
        BinOp::AddAssign(_)
        | BinOp::SubAssign(_)
        | BinOp::MulAssign(_)
        | BinOp::DivAssign(_)
        | BinOp::RemAssign(_)
        | BinOp::BitXorAssign(_)
        | BinOp::BitAndAssign(_)
        | BinOp::BitOrAssign(_)
        | BinOp::ShlAssign(_)
        | BinOp::ShrAssign(_) => {
            let mut pieces =
                vec![Text("(match ".to_owned()), Source(right), Text(format!(" {{ {r} => "))];
            for (id, other) in changes {
                pieces.push(Text(format!("if {} {{ ", switch(*id))));
                pieces.push(Source(left.clone()));
                pieces.push(Text(format!(" {other} {r}; }} else ")));
            }
            pieces.push(Text("{ ".to_owned()));
            pieces.push(Source(left));
            pieces.push(Text(format!(" {sign} {r}; }} }})")));
            pieces
        }
        _ => {
            let compared = matches!(
                op,
                BinOp::Eq(_)
                    | BinOp::Ne(_)
                    | BinOp::Lt(_)
                    | BinOp::Le(_)
                    | BinOp::Gt(_)
                    | BinOp::Ge(_)
            );
            let by = if compared { "&" } else { "" };
            let mut text = format!(")) {{ ({l}, {r}) => ");
            for (id, other) in changes {
                text += &format!("if {} {{ {l} {other} {r} }} else ", switch(*id));
            }
            text += &format!("{{ {l} {sign} {r} }} }})");
            vec![
                Text(format!("(match ({by}(")),
                Source(left),
                Text(format!("), {by}(")),
                Source(right),
                Text(text),
            ]
        }
    }
}

/// Whether an operand of `&&` binds by `let`.
fn has_let(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

/// An operator as it is written.
fn quote(op: &impl Spanned) -> String {
    op.span().source_text().unwrap_or_default()
}
