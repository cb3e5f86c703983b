//! The usual recorder, which keeps a run as plain values.

mod piece;

use std::ops::ControlFlow;

use piece::Piece;

use crate::error::Error;
use crate::point::Point;
use crate::record::{Accepted, Event, Grazing, Needs, Record};
use crate::system::{Next, System, Vector};

/// The times at which a trajectory keeps samples.
///
/// ```
/// use deltazero_solvers::Grid;
///
/// assert_eq!(Grid::uniform(0.5, 1.2), Grid::Times(vec![0.5, 1.0]));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Grid {
    /// At the end of every accepted step.
    Steps,
    /// At these times, in the order in which the run passes them.
    Times(Vec<f64>),
}

impl Grid {
    /// `t = spacing · k` for `k = 1 … ⌊t_end/spacing + 1e-9⌋`, for a run from zero to `t_end`; every accepted step if
    /// `spacing` is zero. Where `t_end` is below zero, so is the spacing. The last time is `t_end` itself where rounding
    /// would put it beyond.
    ///
    /// # Panics
    /// Where there are more times than memory holds, as up to an infinite `t_end`.
    pub fn uniform(spacing: f64, t_end: f64) -> Self {
        if spacing == 0.0 {
            return Self::Steps;
        }
        let n = (t_end / spacing + 1e-9).floor() as u64;
        let within = |t: f64| if t.abs() > t_end.abs() { t_end } else { t };
        Self::Times((1..=n).map(|k| within(spacing * k as f64)).collect())
    }
}

/// A state that was kept.
///
/// ```
/// use deltazero_solvers::problems::{FrictionMode, FrictionOscillator};
/// use deltazero_solvers::{Grid, Run, Sample, Trajectory};
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let run = Run::of(&slider, slider.start()).method("dop853").tolerance(1e-9, 1e-9);
/// let samples = run.keep(Trajectory::on(Grid::Times(vec![1.0, 10.0]))).to(10.0)?.trajectory.samples;
/// let [Sample { t: 1.0, mode: FrictionMode::SlipMinus, y: slips }, at_rest] = &samples[..] else {
///     panic!("the mass slips at first: {samples:?}")
/// };
/// assert!((slips[0] - (0.15 + 0.85 * 1.0_f64.cos())).abs() < 1e-8);
/// assert_eq!((at_rest.mode, at_rest.y[1]), (FrictionMode::Stick, 0.0));
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample<Y, M> {
    /// Time.
    pub t: f64,
    /// Mode; at an event, the mode after it.
    pub mode: M,
    /// State; at an event, the state after it.
    pub y: Y,
}

/// An event that was kept.
///
/// ```
/// use std::f64::consts::PI;
///
/// use deltazero_solvers::problems::{FrictionMode, FrictionOscillator};
/// use deltazero_solvers::{Next, Run};
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let run = Run::of(&slider, slider.start()).method("dop853").tolerance(1e-9, 1e-9).to(10.0)?;
/// let [_, _, last] = &run.trajectory.events[..] else { panic!("it turns twice, and sticks") };
/// assert!((last.t - 3.0 * PI).abs() < 1e-7);
/// assert_eq!((last.before, last.guard), (FrictionMode::SlipMinus, 0));
/// assert_eq!(last.after, Next::Mode(FrictionMode::Stick));
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Switch<M> {
    /// Time.
    pub t: f64,
    /// The guard that was violated.
    pub guard: usize,
    /// Mode before.
    pub before: M,
    /// What followed.
    pub after: Next<M>,
}

/// Samples, events and grazing guards of a run.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Grid, Run, Trajectory};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let samples = Trajectory::on(Grid::uniform(0.1, 1.0));
/// let run = Run::of(&ball, ball.start()).tolerance(1e-8, 1e-8);
/// let trajectory = run.keep(samples).to(1.0)?.trajectory;
/// assert_eq!(trajectory.samples.len(), 10);
/// let (bounce, [before, after]) = (&trajectory.events[0], trajectory.sides[0]);
/// assert!((bounce.t - ball.bounce_time(0)).abs() < 1e-6);
/// assert_eq!(after[1], -0.5 * before[1]);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trajectory<Y, M> {
    /// The start of the first run; `None` before it.
    pub start: Option<Sample<Y, M>>,
    /// Samples, in the order of the run.
    pub samples: Vec<Sample<Y, M>>,
    /// Events, in the order of the run.
    pub events: Vec<Switch<M>>,
    /// States before and after the transition of each event.
    pub sides: Vec<[Y; 2]>,
    /// Guards that grazed, step by step in the order of the run; within a step in any order.
    pub grazings: Vec<Grazing<M>>,
    grid: Grid,
    next: usize,
    /// The solution on each step, where it is kept.
    pieces: Option<Vec<Piece<Y, M>>>,
}

impl<Y, M> Trajectory<Y, M> {
    /// An empty trajectory that keeps samples on `grid`.
    pub fn on(grid: Grid) -> Self {
        let capacity = match &grid {
            Grid::Steps => 0,
            Grid::Times(times) => times.len(),
        };
        Self {
            start: None,
            samples: Vec::with_capacity(capacity),
            events: Vec::new(),
            sides: Vec::new(),
            grazings: Vec::new(),
            grid,
            next: 0,
            pieces: None,
        }
    }

    /// An empty trajectory that keeps events and no samples.
    pub fn of_events() -> Self {
        Self::on(Grid::Times(Vec::new()))
    }

    /// An empty trajectory that keeps the samples at the ends of the steps and the solution between them, which can be
    /// asked [at](Self::at) any time.
    pub fn dense() -> Self {
        Self { pieces: Some(Vec::new()), ..Self::on(Grid::Steps) }
    }
}

impl<Y: Vector<f64>, M: Clone> Trajectory<Y, M> {
    /// The solution at `t` by the dense output of the method, to rounding; at an event, mode and state after it. `None`
    /// outside the run, and where the trajectory is not [dense](Self::dense).
    ///
    /// ```
    /// # use deltazero_solvers::problems::BouncingBall;
    /// use deltazero_solvers::{Control, Integration, Method, Tolerance, Trajectory};
    ///
    /// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    /// let method = Method::named("dop853").ok_or("no such method")?;
    /// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
    /// let mut solver = method.solver(&ball, control)?;
    /// let mut trajectory = Trajectory::dense();
    /// Integration::new(&ball, 0.0, ball.start()).run(1.3, &mut *solver, &mut trajectory)?;
    /// let height = trajectory.at(0.7).ok_or("outside the run")?.y[0];
    /// assert!((height - ball.state(0.7)[0]).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn at(&self, t: f64) -> Option<Sample<Y, M>> {
        let pieces = self.pieces.as_ref()?;
        let Some((first, last)) = pieces.first().zip(pieces.last()) else {
            let start = self.start.as_ref().filter(|start| start.t == t)?;
            return Some(self.left(start.clone()));
        };
        let ahead = (last.t1 - first.t0).signum();
        if t == last.t1 {
            return self.samples.last().cloned();
        }
        if (t - last.t1) * ahead > 0.0 {
            return None;
        }
        let n_begun = pieces.partition_point(|piece| (piece.t0 - t) * ahead <= 0.0);
        let piece = pieces.get(n_begun.checked_sub(1)?)?;
        Some(Sample { t, mode: piece.mode.clone(), y: piece.at(t) })
    }

    /// The `start` of a run without steps, after the events there.
    fn left(&self, start: Sample<Y, M>) -> Sample<Y, M> {
        let Some((event, [_, y])) = self.events.last().zip(self.sides.last()) else { return start };
        let mode = if let Next::Mode(after) = &event.after { after } else { &event.before };
        Sample { t: start.t, mode: mode.clone(), y: y.clone() }
    }
}

impl<P: System> Record<P> for Trajectory<P::State<f64>, P::Mode> {
    /// # Errors
    /// [`Error::BadArgument`] for a sample time that is not finite, before the start, or not after the one before it.
    fn begin(&mut self, start: &Point<P>, t_end: f64) -> Result<(), Error> {
        let Point { t: t0, y, mode } = start;
        self.start.get_or_insert_with(|| Sample { t: *t0, mode: mode.clone(), y: y.clone() });
        let Grid::Times(times) = &self.grid else { return Ok(()) };
        let ahead = (t_end - t0).signum();
        let mut before = *t0;
        for (i, &t) in times[self.next..].iter().enumerate() {
            let is_in_order = (t - before) * ahead > 0.0 || i == 0 && t == *t0;
            if !(is_in_order && t.is_finite()) {
                let allowed = "sample times must be finite, not before the start, each after the one before it";
                return Err(Error::BadArgument { name: "sample time", value: t, allowed });
            }
            before = t;
        }
        if *t0 == t_end && times.get(self.next) == Some(t0) {
            self.samples.push(Sample { t: *t0, mode: mode.clone(), y: y.clone() });
            self.next += 1;
        }
        Ok(())
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let (step, mode) = (accepted.step, accepted.mode.clone());
        if let Some(pieces) = &mut self.pieces {
            pieces.push(Piece::of(step, mode.clone()));
        }
        match &self.grid {
            Grid::Steps => self.samples.push(Sample { t: step.t1(), mode, y: step.y1().clone() }),
            Grid::Times(times) => {
                let [t0, t1] = [step.t0(), step.t1()];
                // A step may be so short that its time does not change; which way it goes is not seen from it.
                let passed = |t: f64| t == t1 || (t0 < t1 && t < t1) || (t0 > t1 && t > t1);
                while let Some(&t) = times.get(self.next).filter(|&&t| passed(t)) {
                    let mut y = P::State::from_fn(step.y1().as_ref().len(), |_| 0.0);
                    step.interpolate(t, &mut y);
                    self.samples.push(Sample { t, mode: mode.clone(), y });
                    self.next += 1;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let Event { t, guard, y_before, y, .. } = *event;
        self.sides.push([y_before.clone(), y.clone()]);
        let (before, after) = (event.before.clone(), event.after.clone());
        self.events.push(Switch { t, guard, before, after: after.clone() });
        if let Some(last) = self.samples.last_mut()
            && last.t == t
        {
            if let Next::Mode(mode) = after {
                last.mode = mode;
            }
            last.y.clone_from(y);
        }
        ControlFlow::Continue(())
    }

    fn grazing(&mut self, grazing: &Grazing<P::Mode>) {
        self.grazings.push(grazing.clone());
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        match &self.grid {
            Grid::Steps if self.pieces.is_some() => Needs::DenseOutput,
            Grid::Steps => Needs::Ends,
            Grid::Times(times) => match times.get(self.next) {
                Some(&t) => Needs::to_sample(t, t0, t1),
                None => Needs::Nothing,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_multiples_of_the_spacing_forward_and_backward() {
        assert_eq!(Grid::uniform(0.5, 1.2), Grid::Times(vec![0.5, 1.0]));
        assert_eq!(Grid::uniform(-0.5, -1.2), Grid::Times(vec![-0.5, -1.0]));
        // 3 · 0.1 is above 0.3.
        assert_eq!(Grid::uniform(0.1, 0.3), Grid::Times(vec![0.1, 0.2, 0.3]));
        assert_eq!(Grid::uniform(-0.1, -0.3), Grid::Times(vec![-0.1, -0.2, -0.3]));
        assert_eq!(Grid::uniform(0.1, -0.3), Grid::Times(Vec::new()));
    }
}
