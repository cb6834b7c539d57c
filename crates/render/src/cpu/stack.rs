//! Entries on the way down a tree, or of a batch.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// A stack of fixed size that costs nothing to make: clearing its memory would take longer than most traversals.
pub(super) struct Stack<T: Copy, const SIZE: usize> {
    entries: [MaybeUninit<T>; SIZE],
    /// Every entry below it was written.
    pub(super) size: usize,
}

impl<T: Copy, const SIZE: usize> Stack<T, SIZE> {
    pub(super) const fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; SIZE], size: 0 }
    }

    /// Without a branch: what is not wanted is written and then forgotten.
    #[inline]
    pub(super) fn push_if(&mut self, value: T, is_wanted: bool) {
        self.size = self.put_if(self.size, value, is_wanted);
    }

    /// [`Stack::push_if`] for a size that the caller keeps, in a register; the new one.
    #[inline]
    pub(super) fn put_if(&mut self, size: usize, value: T, is_wanted: bool) -> usize {
        self.entries[size] = MaybeUninit::new(value);
        size + usize::from(is_wanted)
    }

    #[inline]
    pub(super) fn push(&mut self, value: T) {
        self.push_if(value, true);
    }

    pub(super) fn as_slice(&self) -> &[T] {
        // SAFETY: every entry below the size was written.
        unsafe { std::slice::from_raw_parts(self.entries.as_ptr().cast(), self.size) }
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [T] {
        // SAFETY: every entry below the size was written.
        unsafe { std::slice::from_raw_parts_mut(self.entries.as_mut_ptr().cast(), self.size) }
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<T> {
        self.size = self.size.checked_sub(1)?;
        // SAFETY: every entry below the size was written by `push_if`.
        Some(unsafe { self.entries[self.size].assume_init() })
    }

    /// Puts a value below those that `is_below` says it is to be below, among the entries from `base` on.
    #[inline]
    pub(super) fn insert(&mut self, base: usize, value: T, is_below: impl Fn(&T) -> bool) {
        let mut place = self.size;
        while place > base {
            // SAFETY: every entry below the size was written.
            let other = unsafe { self.entries[place - 1].assume_init() };
            if !is_below(&other) {
                break;
            }
            self.entries[place] = MaybeUninit::new(other);
            place -= 1;
        }
        self.entries[place] = MaybeUninit::new(value);
        self.size += 1;
    }
}
