//! Decoders of other crates, held: where one panics on a file, that file is refused and the program goes on.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is inside [`contained`].
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// What `call` returns, or the first line of what it says when it panics. Nothing is printed then.
///
/// For calls into other crates only: a panic of this project is a bug that must be seen.
pub(super) fn contained<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let hook = take_hook();
        set_hook(Box::new(move |info| {
            if !CONTAINED.get() {
                hook(info);
            }
        }));
    });
    let outer = CONTAINED.replace(true);
    // What the call has half done is dropped with it.
    let done = catch_unwind(AssertUnwindSafe(call));
    CONTAINED.set(outer);
    done.map_err(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| payload.downcast_ref::<&str>().copied());
        said.and_then(|said| said.lines().next()).unwrap_or("no reason").to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_answer() {
        assert_eq!(contained(|| 2), Ok(2));
        let numbers: Vec<i32> = Vec::new();
        assert!(contained(|| numbers[3]).unwrap_err().contains("index"));
        assert_eq!(contained(|| -> i32 { panic!("of {}\nlines", 2) }), Err("of 2".to_owned()));
        assert!(!CONTAINED.get());
        assert_eq!(contained(|| contained(|| panic!("inner")).map(|()| 1)), Ok(Err("inner".to_owned())));
    }
}
