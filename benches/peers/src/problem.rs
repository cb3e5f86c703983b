//! The one problem that every tool is given, and the one judge of what it delivers.

use std::error::Error;

use deltazero::config::Config;
use deltazero::model::{Block, Joints, Mode, State};
use deltazero::run::without_start;
use deltazero_solvers::ModeOfState;
use deltazero_study::errors::{EventMatch, match_events, worse};
use deltazero_study::run::ModeChange;

/// The golden states, and their mode changes.
const STATES: &str = include_str!("../../../tests/golden/pin_table1.csv");
const EVENTS: &str = include_str!("../../../tests/golden/pin_table1.events.csv");

/// Reading `pin` of Table 1, 0–2 s: two joints of six states, 200 samples of each to deliver.
pub(crate) struct Problem {
    /// Both joints.
    pub(crate) mechanism: Joints,
    /// Times of the samples [s].
    pub(crate) times: Vec<f64>,
    /// End of the run [s].
    pub(crate) t_end: f64,
    golden: [Track; 2],
    theta: f64,
}

/// What a tool delivers of one joint.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    /// States at the sample times, in the block's own order (X, Y, θ and their rates).
    pub(crate) samples: Vec<State<f64>>,
    /// Mode changes, the start's own included.
    pub(crate) events: Vec<ModeChange>,
    /// Right-hand sides of this joint, where the tool counts them.
    pub(crate) n_rhs: Option<u64>,
}

/// What the golden run says of a delivery.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// Error `e`: the worst sample's `|Δpin|/c` or `|Δθ|/θ_s`.
    pub(crate) e: f64,
    /// Contacts begun and ended.
    pub(crate) delta: EventMatch,
    /// Slip reversals.
    pub(crate) slip: EventMatch,
}

impl Problem {
    /// The problem with its golden run.
    ///
    /// # Errors
    /// Where a golden file is not what it should be.
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let mechanism = Joints::from(&Config::table1()?);
        let mut golden = [Track::default(), Track::default()];
        let mut times = Vec::new();
        for [joint, t, _mode, y @ ..] in rows::<9>(STATES)? {
            let block = &mechanism.blocks()[joint as usize - 1];
            // The exchange of coordinates is its own inverse.
            golden[joint as usize - 1].samples.push(block.in_paper_order(&y));
            if joint == 1.0 {
                times.push(t);
            }
        }
        for [joint, t, before, after] in rows::<4>(EVENTS)? {
            let change = ModeChange::new(t, before as i8, after as i8);
            golden[joint as usize - 1].events.push(change);
        }
        let angles = golden.iter().flat_map(|track| &track.samples).map(|y| y[2].abs());
        let theta = angles.fold(0.0, f64::max);
        let t_end = times.last().copied().ok_or("no golden samples")?;
        Ok(Self { mechanism, times, t_end, golden, theta })
    }

    /// Judges a delivery.
    ///
    /// # Errors
    /// Where samples are missing.
    pub(crate) fn judge(&self, delivered: &[Track; 2]) -> Result<Verdict, Box<dyn Error>> {
        let nothing = EventMatch::default();
        let mut verdict = Verdict { e: 0.0, delta: nothing, slip: nothing };
        for ((block, own), golden) in
            self.mechanism.blocks().into_iter().zip(delivered).zip(&self.golden)
        {
            if own.samples.len() != golden.samples.len() {
                return Err(
                    format!("{} samples of {}", own.samples.len(), golden.samples.len()).into()
                );
            }
            let scale = block.error_scale(self.theta);
            for (y, reference) in own.samples.iter().zip(&golden.samples) {
                verdict.e = worse(verdict.e, scale.error(y, reference));
            }
            let [own, golden] = [&own.events, &golden.events].map(|all| without_start(block, all));
            for (sum, of_contact) in [(&mut verdict.delta, true), (&mut verdict.slip, false)] {
                let kind = |events: &[ModeChange]| -> Vec<ModeChange> {
                    let is_contact = |event: &&ModeChange| event.before == 0 || event.after == 0;
                    events.iter().filter(|event| is_contact(event) == of_contact).copied().collect()
                };
                let found = match_events(&kind(own), &kind(golden), scale.event_window);
                sum.paired += found.paired;
                sum.missed += found.missed;
                sum.spurious += found.spurious;
                sum.time_error = sum.time_error.max(found.time_error);
            }
        }
        Ok(verdict)
    }

    /// Runs both joints, one after the other.
    ///
    /// # Errors
    /// The first that `run` has.
    pub(crate) fn both(
        &self,
        mut run: impl FnMut(&Block) -> Result<Track, Box<dyn Error>>,
    ) -> Result<[Track; 2], Box<dyn Error>> {
        Ok([run(&self.mechanism.blocks()[0])?, run(&self.mechanism.blocks()[1])?])
    }
}

/// What a naive run sees of mode changes: the mode that the state has at the end of each step.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    mode: Mode,
    /// The changes so far.
    pub(crate) events: Vec<ModeChange>,
}

impl Watch {
    /// Of a run from the start, which is free.
    pub(crate) fn new() -> Self {
        Self { mode: Mode::Apart, events: Vec::new() }
    }

    /// Looks at the end of a step.
    #[inline]
    pub(crate) fn look(&mut self, block: &Block, t: f64, y: &State<f64>) {
        let after = block.mode_of_state(t, y);
        if after != self.mode {
            self.events.push(ModeChange::new(t, self.mode.code(), after.code()));
            self.mode = after;
        }
    }
}

fn rows<const N: usize>(csv: &str) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
    let row = |line: &str| -> Result<[f64; N], Box<dyn Error>> {
        let fields: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        fields.try_into().map_err(|_| format!("not {N} columns: {line}").into())
    };
    csv.lines().skip(1).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_golden_run_judges_itself_right() {
        let problem = Problem::new().unwrap();
        let verdict = problem.judge(&problem.golden).unwrap();
        assert_eq!(verdict.e, 0.0);
        assert_eq!((verdict.delta.paired, verdict.slip.paired), (24 + 28, 5 + 3));
        assert_eq!((verdict.delta.spurious, verdict.slip.spurious), (0, 0));
    }
}
