//! Long work that its caller can stop.

use crate::error::Result;

/// Asked now and then during long work whether to go on.
pub type Pulse<'a> = &'a mut dyn FnMut() -> Result<()>;

/// Units of work (a knot, a row) between two calls of the pulse: a few milliseconds.
const WORK_PER_PULSE: u32 = 1 << 16;

/// Counts work and asks in time.
pub(crate) struct Watch<'a> {
    pulse: Pulse<'a>,
    work: u32,
    /// An error once the caller has asked to stop.
    pub outcome: Result<()>,
}

impl<'a> Watch<'a> {
    pub fn new(pulse: Pulse<'a>) -> Self {
        Self { pulse, work: 0, outcome: Ok(()) }
    }

    /// Whether to go on after so much more work.
    #[inline(always)]
    pub fn go_on(&mut self, work: u32) -> bool {
        self.work += work;
        if self.work >= WORK_PER_PULSE {
            self.ask();
        }
        self.outcome.is_ok()
    }

    #[cold]
    fn ask(&mut self) {
        self.work = 0;
        if self.outcome.is_ok() {
            self.outcome = (self.pulse)();
        }
    }
}
