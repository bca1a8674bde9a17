//! Lists by number.

/// Writes an item of a list by number, which may be the next one.
pub(super) fn place<T>(list: &mut Vec<T>, id: u32, item: T) {
    match list.get_mut(id as usize) {
        Some(slot) => *slot = item,
        None => list.push(item),
    }
}
