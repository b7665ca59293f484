//! De Bruijn sequences: every window of `order` neighbouring symbols occurs once.

use std::collections::{HashMap, HashSet};

use crate::error::{Error, Result};

/// Longest sequence that is drawn: slits are numbered with 16 bits in clouds.
const MAX_LENGTH: u64 = 1 << 16;

/// The lexicographically least De Bruijn sequence over `symbols` symbols, `symbols`^`order` long; read cyclically, every
/// window of `order` neighbours occurs exactly once.
///
/// Concatenates the Lyndon words whose length divides the order, in lexicographic order (H. Fredricksen, J. Maiorana,
/// "Necklaces of beads in k colors and k-ary de Bruijn sequences", Discrete Mathematics 23:207-210, 1978).
///
/// # Errors
/// [`Error::Invalid`] for fewer than two or more than 256 symbols, an order of zero, or a sequence of more than 65536.
///
/// # Examples
/// ```
/// use slcal_core::pattern::{de_bruijn, unique_window};
///
/// let sequence = de_bruijn(4, 3)?;
/// assert_eq!(sequence.len(), 64);
/// // Three neighbours say where in the sequence they stand.
/// assert_eq!(unique_window(&sequence), 3);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn de_bruijn(symbols: u32, order: u32) -> Result<Vec<u8>> {
    let length = u64::from(symbols).checked_pow(order).filter(|&n| n <= MAX_LENGTH);
    let (Some(length), 2..=256, 1..) = (length, symbols, order) else {
        return Err(Error::invalid(
            "De Bruijn sequence",
            format!("2 to 256 symbols, an order of at least 1 and at most {MAX_LENGTH} symbols in all"),
            format!("{symbols} symbols of order {order}"),
        ));
    };
    let (last, order) = ((symbols - 1) as u8, order as usize);
    let mut sequence = Vec::with_capacity(length as usize);
    // Duval's algorithm: the next word repeats the last one up to `order` symbols, drops trailing maximal symbols and
    // raises the one before.
    let mut word = vec![0_u8];
    while !word.is_empty() {
        if order.is_multiple_of(word.len()) {
            sequence.extend_from_slice(&word);
        }
        let period = word.len();
        for i in period..order {
            word.push(word[i - period]);
        }
        while word.last() == Some(&last) {
            word.pop();
        }
        if let Some(tail) = word.last_mut() {
            *tail += 1;
        }
    }
    Ok(sequence)
}

/// The shortest window length whose windows are all different in a sequence that is not wrapped; the whole length for
/// sequences without one. Takes n·log n steps: files from elsewhere may hold any sequence.
#[must_use]
pub fn unique_window(sequence: &[u8]) -> usize {
    // Windows of `length` symbols by number, equal numbers for equal windows; the length doubles until all differ.
    let mut names: Vec<u32> = sequence.iter().map(|&s| u32::from(s)).collect();
    let mut length = 1;
    while length < sequence.len() && !all_differ(&names, 0) {
        if 2 * length >= sequence.len() || all_differ(&names, length) {
            // Two overlapping windows identify a window of any length between the two.
            let (mut shorter, mut longer) = (length, (2 * length).min(sequence.len()));
            while longer - shorter > 1 {
                let middle = usize::midpoint(shorter, longer);
                let differ = all_differ(&names, middle - length);
                *if differ { &mut longer } else { &mut shorter } = middle;
            }
            return longer;
        }
        let mut numbers = HashMap::new();
        names = pairs(&names, length)
            .map(|pair| {
                let next = numbers.len() as u32;
                *numbers.entry(pair).or_insert(next)
            })
            .collect();
        length *= 2;
    }
    length.min(sequence.len())
}

/// The windows identified by each pair of windows `shift` apart.
fn pairs(names: &[u32], shift: usize) -> impl Iterator<Item = (u32, u32)> {
    names.iter().copied().zip(names.iter().copied().skip(shift))
}

fn all_differ(names: &[u32], shift: usize) -> bool {
    let mut seen = HashSet::new();
    pairs(names, shift).all(|pair| seen.insert(pair))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cyclic_window_occurs_exactly_once() {
        for symbols in 2..=6_u32 {
            for order in 1..=4_u32 {
                let s = de_bruijn(symbols, order).unwrap();
                let (n, k) = (s.len(), order as usize);
                assert_eq!(n, (symbols as usize).pow(order));
                let windows: HashSet<Vec<u8>> =
                    (0..n).map(|i| (0..k).map(|j| s[(i + j) % n]).collect()).collect();
                assert_eq!(windows.len(), n, "{symbols} symbols, order {order}");
            }
        }
    }

    #[test]
    fn windows_are_unique_for_all_hues_and_orders_that_patterns_offer() {
        for hues in 2..=12_u64 {
            for order in (1..).take_while(|&o| hues.pow(o) <= MAX_LENGTH) {
                let mut s = de_bruijn(hues as u32, order).unwrap();
                // As patterns lay it out: with its head again at the end.
                s.extend_from_within(..order as usize - 1);
                let window = |w: &[u8]| w.iter().fold(0, |n, &c| n * hues + u64::from(c));
                let mut seen = vec![false; hues.pow(order) as usize];
                for w in s.windows(order as usize) {
                    let at = window(w) as usize;
                    assert!(!std::mem::replace(&mut seen[at], true), "{hues} hues, order {order}");
                }
                assert!(seen.iter().all(|&s| s), "{hues} hues, order {order}");
            }
            assert!(de_bruijn(hues as u32, 17).is_err());
        }
    }

    #[test]
    fn the_window_of_a_sequence_is_its_order() {
        assert_eq!(unique_window(&de_bruijn(4, 3).unwrap()), 3);
        assert_eq!(unique_window(&de_bruijn(3, 4).unwrap()), 4);
        assert_eq!(unique_window(&[0, 1, 2]), 1);
        assert_eq!(unique_window(&[1, 1, 1, 1]), 4);
        assert_eq!(unique_window(&[]), 0);
        assert_eq!(unique_window(&[7]), 1);
    }

    #[test]
    fn the_window_is_the_one_that_trying_all_lengths_finds() {
        let by_trying = |s: &[u8]| {
            let differ = |n: &usize| s.windows(*n).collect::<HashSet<_>>().len() == s.len() + 1 - n;
            (1..s.len()).find(differ).unwrap_or(s.len())
        };
        let mut state = 1_u32;
        for length in 0..60 {
            for symbols in 1..4 {
                let s: Vec<u8> = (0..length)
                    .map(|_| {
                        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        ((state >> 16) % symbols) as u8
                    })
                    .collect();
                assert_eq!(unique_window(&s), by_trying(&s), "{s:?}");
                let twice = [&s[..], &s[..]].concat();
                assert_eq!(unique_window(&twice), by_trying(&twice), "{twice:?}");
            }
        }
    }

    #[test]
    fn a_long_sequence_of_one_colour_takes_no_time() {
        // Comparing all windows of all lengths would take 10^17 steps.
        assert_eq!(unique_window(&vec![3; 1_000_000]), 1_000_000);
    }

    #[test]
    fn impossible_sequences_are_refused() {
        for (symbols, order) in [(0, 3), (1, 3), (257, 1), (4, 0), (4, 9), (256, 30)] {
            assert!(de_bruijn(symbols, order).is_err(), "{symbols}, {order}");
        }
    }
}
