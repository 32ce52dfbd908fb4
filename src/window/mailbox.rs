//! A place for the latest word from one thread to another: what was not taken yet is replaced, so nobody works off a queue.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What lies in it.
enum Slot<T> {
    Empty,
    Full(T),
    /// Nobody puts anything in any more.
    Closed,
}

/// The end that puts in. When it goes, the other end hears of it.
pub struct Sender<T>(Arc<(Mutex<Slot<T>>, Condvar)>);

/// The end that takes out.
pub struct Receiver<T>(Arc<(Mutex<Slot<T>>, Condvar)>);

/// A mailbox's two ends.
pub fn mailbox<T>() -> (Sender<T>, Receiver<T>) {
    let shared = Arc::new((Mutex::new(Slot::Empty), Condvar::new()));
    (Sender(Arc::clone(&shared)), Receiver(shared))
}

/// A thread that died while it held the lock left a whole value behind: slots are replaced, not changed.
fn lock<T>(slot: &Mutex<Slot<T>>) -> MutexGuard<'_, Slot<T>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> Sender<T> {
    /// Replaces what lies there.
    pub fn put(&self, value: T) {
        *lock(&self.0.0) = Slot::Full(value);
        self.0.1.notify_one();
    }
}

impl<T> Drop for Sender<T> {
    fn drop(&mut self) {
        *lock(&self.0.0) = Slot::Closed;
        self.0.1.notify_one();
    }
}

impl<T> Receiver<T> {
    /// Waits for the latest; none once the other end is gone.
    pub fn take(&self) -> Option<T> {
        let mut slot = lock(&self.0.0);
        loop {
            match std::mem::replace(&mut *slot, Slot::Empty) {
                Slot::Full(value) => return Some(value),
                Slot::Closed => {
                    *slot = Slot::Closed;
                    return None;
                }
                Slot::Empty => slot = self.0.1.wait(slot).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    /// Whether something newer waits, or the other end is gone: what is being made is then not wanted any more.
    pub fn superseded(&self) -> bool {
        !matches!(*lock(&self.0.0), Slot::Empty)
    }
}
