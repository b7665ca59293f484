//! The modules of a crate: what each defines, imports and mentions, tests left out.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The texts of a crate by path below `src`, with `/` between folders.
pub(crate) type Texts = BTreeMap<String, String>;

/// One `use` without its braces.
pub(crate) struct Import {
    pub(crate) path: Vec<String>,
    /// The name that the module gains; `*` for a glob.
    pub(crate) name: String,
    /// Whether it stands behind `pub`.
    pub(crate) exported: bool,
}

#[derive(Default)]
pub(crate) struct Module {
    pub(crate) file: String,
    pub(crate) children: BTreeSet<String>,
    pub(crate) defined: BTreeSet<String>,
    pub(crate) imports: Vec<Import>,
    /// Paths and single names outside of `use`.
    pub(crate) mentioned: BTreeSet<Vec<String>>,
}

/// The modules of a crate by path; the root's is empty.
pub(crate) type Modules = BTreeMap<Vec<String>, Module>;

/// The Rust files below a folder.
pub(crate) fn read(folder: &Path) -> Texts {
    let mut texts = Texts::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            texts.extend(read(&path).into_iter().map(|(inner, text)| (format!("{name}/{inner}"), text)));
        } else if path.extension().is_some_and(|e| e == "rs") {
            texts.insert(name, fs::read_to_string(&path).unwrap());
        }
    }
    texts
}

/// Follows the `mod` declarations from `lib.rs`, except into modules for tests.
pub(crate) fn modules(texts: &Texts) -> Modules {
    let mut modules = Modules::new();
    add(texts, "lib.rs", Vec::new(), None, &mut modules);
    modules
}

/// Adds a module, whose body is given where it is inline, and those within it.
fn add(texts: &Texts, file: &str, path: Vec<String>, body: Option<TokenStream>, modules: &mut Modules) {
    let parsed = || TokenStream::from_str(&texts[file]).unwrap_or_else(|e| panic!("{file}: {e}"));
    let mut module = Module { file: file.into(), ..Module::default() };
    let mut inner = Vec::new();
    scan(body.unwrap_or_else(parsed), Some(&mut inner), &mut module);
    for (name, body) in inner {
        let child = [path.as_slice(), std::slice::from_ref(&name)].concat();
        module.children.insert(name);
        let stem = child.join("/");
        let own =
            [format!("{stem}.rs"), format!("{stem}/mod.rs")].into_iter().find(|f| texts.contains_key(f));
        let file = if body.is_some() { Some(file.to_owned()) } else { own };
        let file = file.unwrap_or_else(|| panic!("no file for the module {stem}"));
        add(texts, &file, child, body, modules);
    }
    modules.insert(path, module);
}

/// Modules declared in a module, with their body where it is inline.
type Inner = Vec<(String, Option<TokenStream>)>;

/// Reads a module, or without `inner` what stands within an item.
fn scan(stream: TokenStream, mut inner: Option<&mut Inner>, module: &mut Module) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let mut exported = false;
    let mut i = 0;
    while i < tokens.len() {
        let still_exported = exported;
        exported = false;
        match &tokens[i] {
            TokenTree::Punct(p) if p.as_char() == '#' => {
                i = attribute(&tokens, i, module);
                continue;
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
            TokenTree::Group(group) => scan(group.stream(), None, module),
            TokenTree::Ident(word) => match (word.to_string().as_str(), name_at(&tokens, i + 1)) {
                ("pub", _) => {
                    exported = true;
                    i += usize::from(group_at(&tokens, i + 1, Delimiter::Parenthesis));
                }
                // Not the `use<'a>` of a type.
                ("use", _) if !is_punct(&tokens, i + 1, '<') => {
                    let end = i + end_of(&tokens[i..], |t| is_char(t, ';'));
                    add_imports(&tokens[i + 1..end], &[], still_exported, &mut module.imports);
                    i = end;
                }
                ("mod", Some(name)) if inner.is_some() => {
                    let body = match &tokens[i + 2] {
                        TokenTree::Group(body) => Some(body.stream()),
                        _ => None,
                    };
                    inner.as_mut().unwrap().push((name, body));
                    i += 2;
                }
                ("fn" | "struct" | "enum" | "trait" | "type" | "const" | "static", Some(name))
                    if inner.is_some() =>
                {
                    module.defined.insert(name);
                }
                _ => {
                    let path = path_at(&tokens[i..]);
                    let length = path.len();
                    // A field or a method, but not the end of a range.
                    let of_value =
                        i > 0 && is_punct(&tokens, i - 1, '.') && !(i > 1 && is_punct(&tokens, i - 2, '.'));
                    if !of_value {
                        module.mentioned.insert(path);
                    }
                    i += 3 * (length - 1);
                }
            },
        }
        i += 1;
    }
}

/// Reads the attribute at `i` and returns what is to be read next: behind the item if that is only for tests.
fn attribute(tokens: &[TokenTree], i: usize, module: &mut Module) -> usize {
    let at = i + 1 + usize::from(is_punct(tokens, i + 1, '!'));
    let Some(TokenTree::Group(group)) = tokens.get(at) else { return i + 1 };
    let text = group.stream().to_string();
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    if plain == "test" || plain == "cfg(test)" || plain.starts_with("cfg(all(test,") {
        let ends = |t: &TokenTree| match t {
            TokenTree::Group(g) => g.delimiter() == Delimiter::Brace,
            other => is_char(other, ';') || is_char(other, ','),
        };
        return at + 2 + end_of(&tokens[at + 1..], ends);
    }
    // A function named in a text, as in `#[serde(default = "crate::module::function")]`.
    if !plain.starts_with("doc") {
        for name in text.split('"').skip(1).step_by(2).filter(|t| t.contains("::")) {
            scan(TokenStream::from_str(name).unwrap(), None, module);
        }
    }
    at + 1
}

fn add_imports(tokens: &[TokenTree], before: &[String], exported: bool, imports: &mut Vec<Import>) {
    let mut path = before.to_vec();
    let mut name = None;
    for (i, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Ident(word) if word == "as" => {
                name = name_at(tokens, i + 1);
                break;
            }
            TokenTree::Ident(word) if word == "self" && !path.is_empty() => {}
            TokenTree::Ident(word) => path.push(word.to_string()),
            TokenTree::Group(group) => {
                let parts: Vec<TokenTree> = group.stream().into_iter().collect();
                for part in parts.split(|t| is_char(t, ',')).filter(|part| !part.is_empty()) {
                    add_imports(part, &path, exported, imports);
                }
                return;
            }
            other if is_char(other, '*') => name = Some("*".into()),
            _ => {}
        }
    }
    let name = name.unwrap_or_else(|| path.last().unwrap().clone());
    imports.push(Import { path, name, exported });
}

/// The path `a::b::c` with which the tokens begin.
fn path_at(tokens: &[TokenTree]) -> Vec<String> {
    let mut path = Vec::from_iter(name_at(tokens, 0));
    while is_punct(tokens, 3 * path.len() - 2, ':') && is_punct(tokens, 3 * path.len() - 1, ':') {
        let Some(name) = name_at(tokens, 3 * path.len()) else { break };
        path.push(name);
    }
    path
}

fn name_at(tokens: &[TokenTree], i: usize) -> Option<String> {
    match tokens.get(i) {
        Some(TokenTree::Ident(name)) => Some(name.to_string()),
        _ => None,
    }
}

fn group_at(tokens: &[TokenTree], i: usize, delimiter: Delimiter) -> bool {
    matches!(tokens.get(i), Some(TokenTree::Group(g)) if g.delimiter() == delimiter)
}

fn is_punct(tokens: &[TokenTree], i: usize, wanted: char) -> bool {
    tokens.get(i).is_some_and(|t| is_char(t, wanted))
}

fn is_char(token: &TokenTree, wanted: char) -> bool {
    matches!(token, TokenTree::Punct(p) if p.as_char() == wanted)
}

fn end_of(tokens: &[TokenTree], ends: impl Fn(&TokenTree) -> bool) -> usize {
    tokens.iter().position(ends).unwrap_or(tokens.len())
}
