//! Plants every forbidden arrow, in every spelling, in a made-up crate: each must be found.

use std::fmt::Write as _;

use crate::page;
use crate::source::{Texts, modules};
use crate::table::{Row, disagreements, rows};
use crate::{arrows, source};

/// A crate with the modules of the table, each of which has an `Item`, re-exported at the root, and a file further down.
fn made_up(table: &[Row]) -> Texts {
    let mut texts = Texts::new();
    let mut root = String::new();
    for name in table.iter().flat_map(|row| &row.modules) {
        writeln!(root, "pub mod {name};\npub use {name}::Item as {name}_item;").unwrap();
        texts.insert(format!("{name}/mod.rs"), "mod inner;\npub struct Item;\npub fn call() {}\n".into());
        texts.insert(format!("{name}/inner/mod.rs"), "mod deep;\n".into());
        texts.insert(format!("{name}/inner/deep.rs"), "struct Own;\n".into());
    }
    texts.insert("lib.rs".into(), root);
    texts
}

/// What is wrong beyond arrows that the made-up crate lacks.
fn forbidden(table: &[Row], texts: &Texts) -> Vec<String> {
    let all = disagreements(table, &modules(texts), &[]);
    all.into_iter().filter(|w| !w.contains("does not use")).collect()
}

const SPELLINGS: [&str; 14] = [
    "use crate::NAME::Item;",
    "use crate::NAME::Item as Other;",
    "pub(crate) use crate::NAME::Item;",
    "use crate::{NAME::{Item, call}};",
    "use crate::{NAME::{self}};",
    "use crate::NAME::*;",
    "use super::super::super::NAME::Item;",
    "use crate::NAME_item;",
    "use crate::NAME; fn f() { NAME::call() }",
    "fn f() { crate::NAME::call() }",
    "fn f() { use crate::NAME::call; call() }",
    "fn f() { println!(\"{:?}\", crate::NAME::Item) }",
    "#[serde(default = \"crate::NAME::call\")] struct Read;",
    "#[cfg(test)] mod tests { fn f() {} }\n#[cfg(test)] use std::fmt;\nuse crate::NAME::Item;",
];

const OF_TESTS: [&str; 6] = [
    "#[cfg(test)] mod tests { use crate::NAME::Item; fn f() { crate::NAME::call() } }",
    "#[cfg(test)] use crate::NAME::Item;",
    "#[cfg(all(test, feature = \"x\"))] use crate::NAME::{Item};",
    "#[test] fn f() { crate::NAME::call() }",
    "/// As [`crate::NAME::Item`]; see use crate::NAME::Item;\nstruct Documented;",
    "const TEXT: &str = \"use crate::NAME::Item;\"; // crate::NAME::call()",
];

#[test]
fn every_forbidden_arrow_is_found_in_every_spelling() {
    let table = rows(&page(), "## Who uses whom");
    assert_eq!(forbidden(&table, &made_up(&table)), [""; 0]);
    let mut planted = 0;
    for row in &table {
        for other in &table {
            let (user, used) = (&row.modules[0], &other.modules[0]);
            let allowed = user == used || row.uses.contains(used) || *used == table[0].modules[0];
            let mut texts = made_up(&table);
            let mut expected = Vec::new();
            for (i, spelling) in SPELLINGS.iter().enumerate() {
                let file = format!("{user}/inner/deep{i}.rs");
                writeln!(texts.get_mut(&format!("{user}/inner/mod.rs")).unwrap(), "mod deep{i};").unwrap();
                texts.insert(file.clone(), spelling.replace("NAME", used));
                expected.extend((!allowed).then(|| format!("{file} uses {used}")));
            }
            expected.sort();
            assert_eq!(forbidden(&table, &texts), expected);
            planted += expected.len();
        }
    }
    assert!(planted > 2000, "{planted}");
}

#[test]
fn what_only_tests_use_is_no_arrow() {
    let table = rows(&page(), "## Who uses whom");
    let (first, last) = (&table[1].modules[0], &table[table.len() - 1].modules[0]);
    for spelling in OF_TESTS {
        let mut texts = made_up(&table);
        texts.get_mut(&format!("{first}/inner/deep.rs")).unwrap().push_str(&spelling.replace("NAME", last));
        assert_eq!(forbidden(&table, &texts), [""; 0], "{spelling}");
    }
}

#[test]
fn a_table_that_differs_from_the_crate_is_found() {
    let row = |modules: &[&str], uses: &[&str]| Row {
        modules: modules.iter().map(ToString::to_string).collect(),
        uses: uses.iter().map(ToString::to_string).collect(),
    };
    let mut texts = made_up(&[row(&["error"], &[]), row(&["low"], &[]), row(&["high"], &[])]);
    texts.insert("high/inner/deep.rs".into(), "use crate::low::Item;".into());
    let wrong = |table: &[Row]| disagreements(table, &modules(&texts), &[]);
    assert_eq!(wrong(&[row(&["error"], &[]), row(&["low"], &[]), row(&["high"], &["low"])]), [""; 0]);
    assert_eq!(
        wrong(&[row(&["error"], &[]), row(&["high"], &["low"])]),
        ["low does not stand above high", "low is not in the table"]
    );
    let with_more = [row(&["error"], &[]), row(&["low"], &["none"]), row(&["high", "none"], &["low"])];
    assert_eq!(
        wrong(&with_more),
        ["none does not stand above low", "there is no none", "low does not use none"]
    );
}

fn circles(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    let texts: Texts = files.iter().map(|(file, text)| ((*file).into(), (*text).into())).collect();
    arrows::circles(&source::modules(&texts))
}

#[test]
fn circles_of_files_are_found() {
    let pair = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; struct A;"),
        ("b.rs", "use crate::a::A; struct B;"),
    ];
    assert_eq!(circles(&pair), [["a.rs", "b.rs"]]);
    let three = [
        ("lib.rs", "mod a; mod b; mod c; pub use {a::A, b::B, c::C};"),
        ("a.rs", "use crate::B; pub struct A;"),
        ("b.rs", "fn f() -> crate::C { crate::C } pub struct B;"),
        ("c.rs", "use super::A; pub struct C;"),
    ];
    assert_eq!(circles(&three), [["a.rs", "b.rs", "c.rs"]]);
    let with_parent = [
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod b; pub use b::work; pub struct A; fn f() { work() }"),
        ("a/b.rs", "use super::A; pub fn work(_: A) {}"),
    ];
    assert_eq!(circles(&with_parent), [["a/b.rs", "a/mod.rs"]]);
}

#[test]
fn a_parent_that_only_hands_on_is_in_no_circle() {
    let files = [
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "//! Both.\nmod b; mod c; pub use b::B; pub use c::work;"),
        ("a/b.rs", "pub struct B; #[cfg(test)] mod tests { use super::super::work; }"),
        ("a/c.rs", "use super::B; pub fn work(_: B) {}"),
    ];
    assert_eq!(circles(&files), [[""; 0]; 0]);
}
