//! Sorting whole numbers by their digits.

/// Bits of a digit.
const BITS: u32 = 11;
/// Below this many, comparing is as quick.
const FEW: usize = 128;

/// Sorts numbers upwards, the quicker the closer numbers of the same upper 32 bits already are to their order; `spare` is room.
///
/// The upper 32 bits, less the least of them, are cut to two digits, by which they are dealt into their order twice; what that
/// leaves is put right one by one.
pub fn sort(keys: &mut Vec<u64>, spare: &mut Vec<u64>) {
    if keys.len() < FEW {
        keys.sort_unstable();
        return;
    }
    let upper = |key: u64| (key >> 32) as u32;
    let (low, high) = keys.iter().fold((u32::MAX, 0), |(low, high), &key| (low.min(upper(key)), high.max(upper(key))));
    let shift = (u32::BITS - (high - low).leading_zeros()).saturating_sub(2 * BITS);
    let code = |key: u64| (upper(key) - low) >> shift;
    const DIGITS: usize = 1 << BITS;
    let mut ends = [[0_u32; DIGITS]; 2];
    let digit = |code: u32, place: usize| (code >> (BITS * place as u32)) as usize % DIGITS;
    for &key in keys.iter() {
        let code = code(key);
        ends[0][digit(code, 0)] += 1;
        ends[1][digit(code, 1)] += 1;
    }
    spare.resize(keys.len(), 0);
    for (place, next) in ends.iter_mut().enumerate() {
        if next.iter().any(|&count| count as usize == keys.len()) {
            continue;
        }
        let mut end = 0;
        for next in next.iter_mut() {
            (*next, end) = (end, end + *next);
        }
        for &key in keys.iter() {
            let next = &mut next[digit(code(key), place)];
            spare[*next as usize] = key;
            *next += 1;
        }
        std::mem::swap(keys, spare);
    }
    for i in 1..keys.len() {
        let key = keys[i];
        let mut at = i;
        while at > 0 && keys[at - 1] > key {
            keys[at] = keys[at - 1];
            at -= 1;
        }
        keys[at] = key;
    }
}
