//! Expressions as trees, with their places.

use crate::report::{Checked, Complaint, Span};
use crate::token::{Place, Token, tokens};

/// A formula.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    pub(crate) kind: Kind,
    pub(crate) span: Span,
}

/// What a formula is.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    /// `1.5`
    Number(f64),
    /// `x`
    Name(String),
    /// `x[i + 1]`
    Element(String, Box<Expression>),
    /// `-x`
    Negative(Box<Expression>),
    /// `a + b - c` or `a * b / c`, from left to right. A long sum is one node, so that trees stay shallow.
    Chain(Box<Expression>, Vec<(Operator, Expression)>),
    /// `a^b`
    Power(Box<Expression>, Box<Expression>),
    /// `f(a, b)`
    Call(String, Vec<Expression>),
    /// `sum(i in 1..n, x[i])`
    Sum(Box<(Indices, Expression)>),
    /// `if(a < b, x, y)`
    Choice(Box<(Comparison, Expression, Expression)>),
}

/// An operator of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
}

/// An index with its bounds, both of which it takes: `i in 1..n`.
#[derive(Clone, Debug)]
pub(crate) struct Indices {
    pub(crate) name: String,
    pub(crate) first: Expression,
    pub(crate) last: Expression,
    pub(crate) span: Span,
}

/// `a > b` or `a < b`.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    pub(crate) left: Expression,
    pub(crate) relation: Relation,
    pub(crate) right: Expression,
}

/// How two sides are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

impl Expression {
    /// Calls `each` with every name in it but those of functions.
    pub(crate) fn for_each_name<'a>(&'a self, each: &mut dyn FnMut(&'a str)) {
        match &self.kind {
            Kind::Number(_) => {}
            Kind::Name(name) => each(name),
            Kind::Element(name, index) => {
                each(name);
                index.for_each_name(each);
            }
            Kind::Negative(inner) => inner.for_each_name(each),
            Kind::Chain(first, rest) => {
                first.for_each_name(each);
                rest.iter().for_each(|(_, inner)| inner.for_each_name(each));
            }
            Kind::Power(base, exponent) => {
                base.for_each_name(each);
                exponent.for_each_name(each);
            }
            Kind::Call(_, arguments) => arguments.iter().for_each(|own| own.for_each_name(each)),
            Kind::Sum(sum) => {
                let (indices, inner) = &**sum;
                [&indices.first, &indices.last, inner]
                    .iter()
                    .for_each(|own| own.for_each_name(each));
            }
            Kind::Choice(choice) => {
                let (Comparison { left, right, .. }, a, b) = &**choice;
                [left, right, a, b].iter().for_each(|own| own.for_each_name(each));
            }
        }
    }
}

/// Parentheses, calls and powers within each other, at most.
const DEEPEST: usize = 100;

/// Parses the whole text as a formula.
pub(crate) fn expression(text: &str, place: Place) -> Checked<Expression> {
    let mut parser = Parser::new(text, place)?;
    let expression = parser.sum()?;
    parser.end(&expression)?;
    Ok(expression)
}

/// Parses the whole text as the condition of an event.
pub(crate) fn condition(text: &str, place: Place) -> Checked<Comparison> {
    let mut parser = Parser::new(text, place)?;
    let comparison = parser.comparison()?;
    match comparison.relation {
        Relation::Equal | Relation::NotEqual => Err(parser.refused_equality(&comparison)),
        _ => {
            parser.end(&comparison.right)?;
            Ok(comparison)
        }
    }
}

/// Parses the whole text as an index with its bounds.
pub(crate) fn indices(text: &str, place: Place) -> Checked<Indices> {
    let mut parser = Parser::new(text, place)?;
    let indices = parser.indices()?;
    parser.end(&indices.last)?;
    Ok(indices)
}

struct Parser<'a> {
    tokens: Vec<(Token<'a>, Span)>,
    at: usize,
    depth: usize,
    /// Just behind the last token.
    end: Span,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str, place: Place) -> Checked<Self> {
        let end = place.span(text.len(), text.len());
        let tokens = tokens(text, place)?;
        if tokens.is_empty() {
            return Err(Complaint::new(place.span(0, text.len()), "a formula is missing here")
                .help("a formula or a number stands in the quotes: `\"-k*x\"`, `\"0\"`"));
        }
        Ok(Self { tokens, at: 0, depth: 0, end })
    }

    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).map(|(token, _)| *token)
    }

    fn span(&self) -> Span {
        self.tokens.get(self.at).map_or(self.end, |(_, span)| *span)
    }

    /// Takes the symbol, if it is next.
    fn take(&mut self, symbol: &str) -> Option<Span> {
        let span = self.span();
        let is_next = matches!(self.peek(), Some(Token::Symbol(next)) if next == symbol);
        self.at += usize::from(is_next);
        is_next.then_some(span)
    }

    fn expect(&mut self, symbol: &str, after: &str) -> Checked<Span> {
        match self.take(symbol) {
            Some(span) => Ok(span),
            None => {
                let complaint =
                    Complaint::new(self.span(), format!("`{symbol}` is missing {after}"));
                Err(complaint.help(
                    "as in `x[i+1]`, `atan2(y, x)`, `sum(i in 1..n, x[i])`, `if(i < n, a, b)`",
                ))
            }
        }
    }

    /// Runs `parse` one level deeper.
    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> Checked<T>) -> Checked<T> {
        if self.depth == DEEPEST {
            let complaint = Complaint::new(self.span(), "this formula is nested too deeply");
            return Err(complaint.help("give an inner part a name in [definitions]"));
        }
        self.depth += 1;
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    /// Complains about a token that does not continue the formula.
    fn end(&self, before: &Expression) -> Checked<()> {
        let Some(token) = self.peek() else { return Ok(()) };
        let span = self.span();
        Err(match token {
            Token::Name("and" | "or" | "not") => refused_logic(span),
            Token::Name(_) | Token::Number(_) | Token::Symbol("(" | "[") => {
                Complaint::new(span, "an operator is missing before this")
                    .help("a product is written with `*`")
                    .and(before.span, "after this")
            }
            Token::Symbol("**") => {
                Complaint::new(span, "`**` is no operator").help("a power is written `a^b`")
            }
            Token::Symbol("&&" | "||" | "!") => refused_logic(span),
            Token::Symbol(">" | "<" | ">=" | "<=" | "==" | "!=" | "=") => {
                let help =
                    "only `when` of an event and the condition of `if(condition, a, b)` compare";
                Complaint::new(span, "a comparison does not stand here").help(help)
            }
            Token::Symbol(")") => Complaint::new(span, "this parenthesis was never opened")
                .help("take it away, or open one before it"),
            Token::Symbol(symbol) => {
                Complaint::new(span, format!("`{symbol}` does not continue a formula")).help(
                    "operators are `+ - * / ^`; arguments in parentheses have `,` between them",
                )
            }
        })
    }

    fn comparison(&mut self) -> Checked<Comparison> {
        if let Some(Token::Name("not") | Token::Symbol("!")) = self.peek() {
            return Err(refused_logic(self.span()));
        }
        let left = self.sum()?;
        let relation = match self.peek() {
            Some(Token::Symbol(">")) => Relation::Greater,
            Some(Token::Symbol(">=")) => Relation::GreaterOrEqual,
            Some(Token::Symbol("<")) => Relation::Less,
            Some(Token::Symbol("<=")) => Relation::LessOrEqual,
            Some(Token::Symbol("==" | "=")) => Relation::Equal,
            Some(Token::Symbol("!=")) => Relation::NotEqual,
            Some(
                Token::Name(_)
                | Token::Number(_)
                | Token::Symbol("(" | "[" | "**" | ")" | "&&" | "||"),
            ) => {
                self.end(&left)?;
                return Err(Complaint::new(self.span(), "a comparison is missing here")
                    .help("write `a > b` or `a < b`"));
            }
            _ => {
                return Err(Complaint::new(self.span(), "a comparison is missing here")
                    .help("write `a > b` or `a < b`"));
            }
        };
        self.at += 1;
        let right = self.sum()?;
        if let Some(Token::Symbol(">" | "<" | ">=" | "<=")) = self.peek() {
            let help = "two bounds are two events";
            return Err(Complaint::new(self.span(), "one comparison is enough").help(help));
        }
        Ok(Comparison { left, relation, right })
    }

    fn refused_equality(&self, comparison: &Comparison) -> Complaint {
        let span = comparison.left.span.to(comparison.right.span);
        Complaint::new(span, "an event is no equality")
            .help("write `a > b` where a rises to b in this mode, `a < b` where it falls to b: the event is then located where they are equal")
    }

    fn indices(&mut self) -> Checked<Indices> {
        let start = self.span();
        let help = "write it as `i in 1..n`; both bounds are taken";
        let Some(Token::Name(name)) = self.peek() else {
            return Err(Complaint::new(start, "the name of an index is missing here").help(help));
        };
        self.at += 1;
        if self.peek() != Some(Token::Name("in")) {
            return Err(Complaint::new(self.span(), "`in` is missing after the index").help(help));
        }
        self.at += 1;
        let first = self.sum()?;
        if self.take("..").is_none() {
            return Err(
                Complaint::new(self.span(), "`..` is missing between the bounds").help(help)
            );
        }
        let last = self.sum()?;
        let span = start.to(last.span);
        Ok(Indices { name: name.to_owned(), first, last, span })
    }

    fn sum(&mut self) -> Checked<Expression> {
        self.chain(Self::product, [("+", Operator::Add), ("-", Operator::Subtract)])
    }

    fn product(&mut self) -> Checked<Expression> {
        self.chain(Self::signed, [("*", Operator::Multiply), ("/", Operator::Divide)])
    }

    /// `link (operator link)*`
    fn chain(
        &mut self,
        link: fn(&mut Self) -> Checked<Expression>,
        operators: [(&str, Operator); 2],
    ) -> Checked<Expression> {
        let (first, mut rest) = (link(self)?, Vec::new());
        let mut span = first.span;
        while let Some((_, operator)) =
            operators.iter().find(|(symbol, _)| self.take(symbol).is_some())
        {
            let next = link(self)?;
            span = span.to(next.span);
            rest.push((*operator, next));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        Ok(Expression { kind: Kind::Chain(Box::new(first), rest), span })
    }

    /// A sign binds less than a power: `-x^2` is −(x²).
    fn signed(&mut self) -> Checked<Expression> {
        if let Some(sign) = self.take("-") {
            let inner = self.deeper(Self::signed)?;
            let span = sign.to(inner.span);
            return Ok(Expression { kind: Kind::Negative(Box::new(inner)), span });
        }
        if self.take("+").is_some() {
            return self.deeper(Self::signed);
        }
        let base = self.atom()?;
        if self.take("^").is_none() {
            return Ok(base);
        }
        let exponent = self.deeper(Self::signed)?;
        let span = base.span.to(exponent.span);
        Ok(Expression { kind: Kind::Power(Box::new(base), Box::new(exponent)), span })
    }

    fn atom(&mut self) -> Checked<Expression> {
        let span = self.span();
        match self.peek() {
            Some(Token::Number(x)) => {
                self.at += 1;
                Ok(Expression { kind: Kind::Number(x), span })
            }
            Some(Token::Name("and" | "or" | "not")) => Err(refused_logic(span)),
            Some(Token::Name(name)) => {
                self.at += 1;
                if self.take("(").is_some() {
                    return self.deeper(|parser| parser.call(name, span));
                }
                if self.take("[").is_none() {
                    return Ok(Expression { kind: Kind::Name(name.to_owned()), span });
                }
                let index = self.deeper(Self::sum)?;
                let span = span.to(self.expect("]", "after the index")?);
                Ok(Expression { kind: Kind::Element(name.to_owned(), Box::new(index)), span })
            }
            Some(Token::Symbol("(")) => {
                self.at += 1;
                let mut inner = self.deeper(Self::sum)?;
                let close = self.take(")").ok_or_else(|| {
                    let complaint = Complaint::new(self.span(), "`)` is missing here");
                    complaint.and(span, "opened here").help("close it where its last operand ends")
                })?;
                inner.span = span.to(close);
                Ok(inner)
            }
            Some(Token::Symbol(symbol)) => {
                let message = format!("a number, a name or `(` is expected, not `{symbol}`");
                Err(Complaint::new(span, message).help("an operator stands between two operands"))
            }
            None => Err(Complaint::new(span, "the formula ends here without its last operand")
                .help("take the last operator away, or write what follows it")),
        }
    }

    /// What follows `name(`.
    fn call(&mut self, name: &str, start: Span) -> Checked<Expression> {
        let kind = match name {
            "sum" => {
                let indices = self.indices()?;
                self.expect(",", "after the bounds of the sum")?;
                Kind::Sum(Box::new((indices, self.sum()?)))
            }
            "if" => {
                let condition = self.comparison()?;
                self.expect(",", "after the condition")?;
                let first = self.sum()?;
                self.expect(",", "between the two cases")?;
                Kind::Choice(Box::new((condition, first, self.sum()?)))
            }
            _ => {
                let mut arguments = vec![self.sum()?];
                while self.take(",").is_some() {
                    arguments.push(self.sum()?);
                }
                Kind::Call(name.to_owned(), arguments)
            }
        };
        let end = self.expect(")", &format!("at the end of `{name}(…)`"))?;
        Ok(Expression { kind, span: start.to(end) })
    }
}

fn refused_logic(span: Span) -> Complaint {
    Complaint::new(span, "the condition of an event is one comparison").help(
        "`or` is two events; `and` is a mode more, entered where the first holds, that waits for the second",
    )
}
