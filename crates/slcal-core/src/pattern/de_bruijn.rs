//! De Bruijn sequences: every window of `order` neighbouring symbols occurs once.

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
/// sequences without one.
#[must_use]
pub fn unique_window(sequence: &[u8]) -> usize {
    (1..sequence.len())
        .find(|&n| {
            let mut seen = std::collections::HashSet::new();
            sequence.windows(n).all(|w| seen.insert(w))
        })
        .unwrap_or(sequence.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

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
    fn the_window_of_a_sequence_is_its_order() {
        assert_eq!(unique_window(&de_bruijn(4, 3).unwrap()), 3);
        assert_eq!(unique_window(&de_bruijn(3, 4).unwrap()), 4);
        assert_eq!(unique_window(&[0, 1, 2]), 1);
        assert_eq!(unique_window(&[1, 1, 1, 1]), 4);
        assert_eq!(unique_window(&[]), 0);
    }

    #[test]
    fn impossible_sequences_are_refused() {
        for (symbols, order) in [(0, 3), (1, 3), (257, 1), (4, 0), (4, 9), (256, 30)] {
            assert!(de_bruijn(symbols, order).is_err(), "{symbols}, {order}");
        }
    }
}
