//! A table from handles to buffers, for backends.

use alloc::vec::Vec;

use crate::BufferId;

/// Keeps what a backend holds for each living buffer; a handle of a buffer that was removed finds nothing.
///
/// A place is used again after its buffer was removed, under another generation; a place whose generations are
/// used up (after 2³² buffers) is never used again.
///
/// ```
/// use backend_api::BufferTable;
///
/// let mut table = BufferTable::new();
/// let first = table.insert("first");
/// assert_eq!(table.remove(first), Some("first"));
/// let second = table.insert("second");
/// assert_eq!(second.index, first.index);
/// assert_eq!((table.get(first), table.get(second)), (None, Some(&"second")));
/// ```
#[derive(Debug)]
pub struct BufferTable<T> {
    places: Vec<Place<T>>,
    free: Vec<u32>,
}

#[derive(Debug)]
struct Place<T> {
    generation: u32,
    content: Option<T>,
}

impl<T> Default for BufferTable<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> BufferTable<T> {
    /// An empty table.
    pub const fn new() -> Self {
        Self { places: Vec::new(), free: Vec::new() }
    }

    /// Adds a buffer and returns its handle.
    pub fn insert(&mut self, content: T) -> BufferId {
        if let Some(index) = self.free.pop() {
            let place = &mut self.places[index as usize];
            place.content = Some(content);
            return BufferId { index, generation: place.generation };
        }
        let index = self.places.len() as u32;
        self.places.push(Place { generation: 0, content: Some(content) });
        BufferId { index, generation: 0 }
    }

    /// Takes a buffer out; its handle is dead from then on. `None` when it was dead before.
    pub fn remove(&mut self, id: BufferId) -> Option<T> {
        let place = self.place_mut(id)?;
        let content = place.content.take()?;
        if let Some(next) = place.generation.checked_add(1) {
            place.generation = next;
            self.free.push(id.index);
        }
        Some(content)
    }

    /// What the handle names, while it lives.
    pub fn get(&self, id: BufferId) -> Option<&T> {
        let place = self.places.get(id.index as usize)?;
        if place.generation == id.generation { place.content.as_ref() } else { None }
    }

    /// What the handle names, to be changed, while it lives.
    pub fn get_mut(&mut self, id: BufferId) -> Option<&mut T> {
        self.place_mut(id)?.content.as_mut()
    }

    /// What several handles name, all to be changed at once; `None` when one is dead or two are the same.
    pub fn get_disjoint_mut<const N: usize>(&mut self, ids: [BufferId; N]) -> Option<[&mut T; N]> {
        if ids.iter().any(|&id| self.get(id).is_none()) {
            return None;
        }
        let places = self.places.get_disjoint_mut(ids.map(|id| id.index as usize)).ok()?;
        places.into_iter().filter_map(|place| place.content.as_mut()).collect::<Vec<_>>().try_into().ok()
    }

    /// All living buffers, by place.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (BufferId, &mut T)> {
        self.places.iter_mut().enumerate().filter_map(|(index, place)| {
            let id = BufferId { index: index as u32, generation: place.generation };
            place.content.as_mut().map(|content| (id, content))
        })
    }

    fn place_mut(&mut self, id: BufferId) -> Option<&mut Place<T>> {
        self.places.get_mut(id.index as usize).filter(|place| place.generation == id.generation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_handles_find_nothing() {
        let mut table = BufferTable::new();
        let a = table.insert(1);
        let b = table.insert(2);
        assert_eq!(table.remove(a), Some(1));
        assert_eq!(table.remove(a), None);
        assert_eq!(table.get_mut(a), None);
        assert_eq!(table.get(BufferId { index: 7, generation: 0 }), None);
        let c = table.insert(3);
        assert_ne!(a, c);
        assert_eq!(table.iter_mut().map(|(id, &mut x)| (id, x)).collect::<Vec<_>>(), [(c, 3), (b, 2)]);
    }

    #[test]
    fn disjoint_access_refuses_twins_and_the_dead() {
        let mut table = BufferTable::new();
        let a = table.insert(1);
        let b = table.insert(2);
        assert_eq!(table.get_disjoint_mut([b, a]), Some([&mut 2, &mut 1]));
        assert_eq!(table.get_disjoint_mut([a, a]), None);
        table.remove(b);
        assert_eq!(table.get_disjoint_mut([a, b]), None);
    }

    #[test]
    fn a_place_without_generations_left_is_retired() {
        let mut table = BufferTable::new();
        table.insert(1);
        table.places[0].generation = u32::MAX;
        let last = BufferId { index: 0, generation: u32::MAX };
        assert_eq!(table.remove(last), Some(1));
        assert_eq!(table.insert(2).index, 1);
        assert_eq!(table.get(last), None);
    }
}
