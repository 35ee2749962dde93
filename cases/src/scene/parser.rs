//! The grammar of expressions.
//!
//! ```text
//! sum      = product { ("+" | "-") product }
//! product  = unary { ("*" | "/") unary }
//! unary    = "-" unary | power
//! power    = primary [ "^" unary ]
//! primary  = number [ unit ] | name [ "(" sum { "," sum } ")" ] | "(" sum ")"
//! unit     = symbol [ exponent ] { ( "/" | "*" | " " ) symbol [ exponent ] }
//! ```
//!
//! And of conditions on particles, which compare expressions:
//!
//! ```text
//! alternatives = conjunction { "or" conjunction }
//! conjunction  = negation { "and" negation }
//! negation     = { "not" } ( comparison | "(" alternatives ")" )
//! comparison   = sum relation sum { relation sum }
//! relation     = "<" | "<=" | ">" | ">=" | "==" | "!="
//! ```
//!
//! A unit binds to its number more tightly than any operator: `1/2 m` is one over two metres.

use super::expression::{Mistake, Node, Operator, Part, Relation, Test};
use super::scanner::Scanner;

/// Length and nesting at most, so that no text exhausts the stack.
const LENGTH: usize = 2000;
const DEPTH: usize = 100;

/// Reads a whole text.
///
/// # Errors
/// At the first place that breaks the grammar.
pub(super) fn parse(text: &str) -> Result<Node, Mistake> {
    whole(text, ["an operator or the end", "name its parts in [parameters]"], |parser| parser.sum())
}

/// Reads a whole text as a condition.
///
/// # Errors
/// At the first place that breaks the grammar.
pub(super) fn parse_condition(text: &str) -> Result<Test, Mistake> {
    let ways_out = ["`and`, `or`, a comparison or the end", "ask for less at once"];
    whole(text, ways_out, |parser| parser.alternatives())
}

fn whole<T>(
    text: &str,
    [end, shorter]: [&'static str; 2],
    read: impl FnOnce(&mut Parser<'_>) -> Result<T, Mistake>,
) -> Result<T, Mistake> {
    if text.len() > LENGTH {
        let message = format!("the expression is longer than {LENGTH} characters");
        return Err(Mistake::new(0..text.len(), message, shorter));
    }
    let mut parser = Parser { scanner: Scanner::new(text), depth: 0, shorter };
    let read = read(&mut parser)?;
    parser.scanner.skip_spaces();
    if parser.scanner.position < text.len() {
        return Err(parser.scanner.unexpected(end));
    }
    Ok(read)
}

struct Parser<'a> {
    scanner: Scanner<'a>,
    depth: usize,
    /// What to do where the text is too long or too deep.
    shorter: &'static str,
}

impl Parser<'_> {
    fn alternatives(&mut self) -> Result<Test, Mistake> {
        let mut tests = vec![self.conjunction()?];
        while self.keyword("or") {
            tests.push(self.conjunction()?);
        }
        Ok(Test::Any(tests))
    }

    fn conjunction(&mut self) -> Result<Test, Mistake> {
        let mut tests = vec![self.negation()?];
        while self.keyword("and") {
            tests.push(self.negation()?);
        }
        Ok(Test::All(tests))
    }

    fn negation(&mut self) -> Result<Test, Mistake> {
        let mut negative = false;
        while self.keyword("not") {
            negative = !negative;
        }
        let test = self.test()?;
        Ok(if negative { Test::Not(Box::new(test)) } else { test })
    }

    fn test(&mut self) -> Result<Test, Mistake> {
        self.scanner.skip_spaces();
        let (start, depth) = (self.scanner.position, self.depth);
        let compared = self.comparison();
        // A bracket stands around a value or around a condition: only what follows it tells which.
        let Err(failed) = compared else { return compared };
        (self.scanner.position, self.depth) = (start, depth);
        match self.bracketed() {
            Err(mistake) if mistake.span.start <= failed.span.start => Err(failed),
            test => test,
        }
    }

    fn bracketed(&mut self) -> Result<Test, Mistake> {
        self.scanner.expect('(')?;
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.scanner.unexpected("fewer brackets"));
        }
        let test = self.alternatives()?;
        self.scanner.expect(')')?;
        self.depth -= 1;
        Ok(test)
    }

    fn comparison(&mut self) -> Result<Test, Mistake> {
        let mut sides = vec![self.sum()?];
        let mut relations = Vec::new();
        while let Some(relation) = self.relation() {
            relations.push(relation);
            sides.push(self.sum()?);
        }
        if relations.is_empty() {
            let mistake = self.scanner.unexpected("a comparison such as `<` or `>=`");
            let help = "compare with < <= > >= == or !=, as in `density < 990 kg/m3`".to_owned();
            return Err(Mistake { help, ..mistake });
        }
        Ok(Test::Compare(sides, relations))
    }

    fn relation(&mut self) -> Option<Relation> {
        self.scanner.skip_spaces();
        // The longer signs first: `<=` begins with `<`.
        let (sign, relation) = Relation::SIGNS
            .into_iter()
            .find(|(sign, _)| self.scanner.text[self.scanner.position..].starts_with(sign))?;
        self.scanner.position += sign.len();
        Some(relation)
    }

    fn keyword(&mut self, wanted: &str) -> bool {
        self.scanner.skip_spaces();
        let before = self.scanner.position;
        let found = self.scanner.word() == wanted;
        if !found {
            self.scanner.position = before;
        }
        found
    }

    fn sum(&mut self) -> Result<Node, Mistake> {
        self.depth += 1;
        if self.depth > DEPTH {
            let end = self.scanner.text.len();
            return Err(Mistake::new(
                self.scanner.position..end,
                "the expression is nested too deeply",
                self.shorter,
            ));
        }
        let mut left = self.product()?;
        while let Some(operator) = self.operator(&[('+', Operator::Add), ('-', Operator::Subtract)]) {
            left = binary(operator, left, self.product()?);
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Node, Mistake> {
        let mut left = self.unary()?;
        while let Some(operator) = self.operator(&[('*', Operator::Multiply), ('/', Operator::Divide)]) {
            left = binary(operator, left, self.unary()?);
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Node, Mistake> {
        self.scanner.skip_spaces();
        let start = self.scanner.position;
        let mut negative = false;
        while self.scanner.eat('-') {
            negative = !negative;
        }
        if self.scanner.position == start {
            return self.power();
        }
        let inner = self.power()?;
        let span = start..inner.span.end;
        Ok(if negative { Node { part: Part::Negate(Box::new(inner)), span } } else { inner })
    }

    fn power(&mut self) -> Result<Node, Mistake> {
        let base = self.primary()?;
        if !self.scanner.eat('^') {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.scanner.unexpected("fewer powers of powers"));
        }
        let exponent = self.unary()?;
        self.depth -= 1;
        Ok(binary(Operator::Power, base, exponent))
    }

    fn primary(&mut self) -> Result<Node, Mistake> {
        self.scanner.skip_spaces();
        let start = self.scanner.position;
        match self.scanner.peek() {
            Some('(') => {
                self.scanner.eat('(');
                let inner = self.sum()?;
                self.scanner.expect(')')?;
                Ok(Node { part: inner.part, span: start..self.scanner.position })
            }
            Some(first) if first.is_ascii_digit() || first == '.' => {
                let part = Part::Number(self.scanner.quantity()?);
                Ok(Node { part, span: start..self.scanner.position })
            }
            Some(first) if first.is_alphabetic() || first == '_' => {
                let name = self.scanner.word().to_owned();
                let end = self.scanner.position;
                if !self.scanner.eat('(') {
                    return Ok(Node { part: Part::Name(name), span: start..end });
                }
                let part = Part::Call(name, self.arguments()?);
                Ok(Node { part, span: start..self.scanner.position })
            }
            _ => Err(self.scanner.unexpected("a number, a name or `(`")),
        }
    }

    fn arguments(&mut self) -> Result<Vec<Node>, Mistake> {
        let mut arguments = vec![self.sum()?];
        while self.scanner.eat(',') {
            arguments.push(self.sum()?);
        }
        self.scanner.expect(')')?;
        Ok(arguments)
    }

    fn operator(&mut self, choices: &[(char, Operator)]) -> Option<Operator> {
        choices.iter().find(|(symbol, _)| self.scanner.eat(*symbol)).map(|(_, operator)| *operator)
    }
}

fn binary(operator: Operator, left: Node, right: Node) -> Node {
    let span = left.span.start..right.span.end;
    Node { part: Part::Binary(operator, Box::new([left, right])), span }
}
