//! Which asset is begun next, and on how many threads: the longest first, as many at once as threads and memory allow.

use super::estimate::Cost;

/// What waits and what is free.
#[derive(Debug)]
pub struct Schedule {
    /// Numbers of what waits with their costs, the longest first.
    waiting: Vec<(usize, Cost)>,
    threads: usize,
    /// None where memory is not bounded.
    memory: Option<u64>,
    running: usize,
}

/// What is begun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begun {
    /// Its number.
    pub item: usize,
    /// Its threads.
    pub threads: usize,
    /// What it is expected to cost.
    pub cost: Cost,
    /// Whether it is expected to take more memory than there is; it runs alone then.
    pub over: bool,
}

impl Schedule {
    /// Of items with their costs. Ties are begun in the order given.
    pub fn new(mut items: Vec<(usize, Cost)>, threads: usize, memory: Option<u64>) -> Self {
        items.sort_by(|(_, a), (_, b)| b.seconds.total_cmp(&a.seconds));
        Self { waiting: items, threads: threads.max(1), memory, running: 0 }
    }

    /// The next to begin now; none where it must wait for another to end, or nothing is left.
    pub fn begin(&mut self) -> Option<Begun> {
        if self.threads == 0 {
            return None;
        }
        let fits = |cost: &Cost| self.memory.is_none_or(|memory| cost.bytes <= memory);
        let found = self.waiting.iter().position(|(_, cost)| fits(cost));
        let (place, over) = match found {
            Some(place) => (place, false),
            None if self.running == 0 && !self.waiting.is_empty() => (0, true),
            None => return None,
        };
        let threads = if over { self.threads } else { self.threads / self.at_once().max(1) };
        let (item, cost) = self.waiting.remove(place);
        let begun = Begun { item, threads: threads.max(1), cost, over };
        self.threads -= begun.threads;
        self.running += 1;
        self.memory = self.memory.map(|memory| memory.saturating_sub(cost.bytes));
        Some(begun)
    }

    /// What was begun is ended.
    pub fn end(&mut self, begun: &Begun, all_memory: Option<u64>) {
        self.threads += begun.threads;
        self.running -= 1;
        self.memory = self.memory.map(|memory| memory + begun.cost.bytes);
        if self.running == 0 {
            self.memory = all_memory;
        }
    }

    /// Takes all that waits.
    pub fn stop(&mut self) -> Vec<usize> {
        self.waiting.drain(..).map(|(item, _)| item).collect()
    }

    /// How many of those that wait could run side by side now, no more than there are threads.
    fn at_once(&self) -> usize {
        let mut left = self.memory.unwrap_or(u64::MAX);
        let mut count = 0;
        for (_, cost) in &self.waiting {
            if count < self.threads && cost.bytes <= left {
                left -= cost.bytes;
                count += 1;
            }
        }
        count
    }
}
