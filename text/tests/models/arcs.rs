//! Hybrid motion made of closed forms: each arc is followed until a surface is passed, found by bisection.

/// A surface of an arc: positive before it.
type Surface<'a> = Box<dyn Fn(f64, [f64; 2]) -> f64 + 'a>;

/// The state at a time of the motion that was at a state at a time before.
type Motion<'a> = Box<dyn Fn(f64, [f64; 2], f64) -> [f64; 2] + 'a>;

/// What ends an arc.
pub(crate) struct End<'a> {
    pub(crate) surface: Surface<'a>,
    /// The arc that follows.
    pub(crate) next: usize,
    /// What the state is then multiplied with.
    pub(crate) reset: [f64; 2],
}

impl<'a> End<'a> {
    pub(crate) fn at(surface: impl Fn(f64, [f64; 2]) -> f64 + 'a, next: usize) -> Self {
        Self { surface: Box::new(surface), next, reset: [1.0, 1.0] }
    }
}

/// A smooth motion until it ends.
pub(crate) struct Arc<'a> {
    pub(crate) name: &'static str,
    pub(crate) motion: Motion<'a>,
    pub(crate) ends: Vec<End<'a>>,
}

/// When each arc ended, what it was and what followed; and the state at the end.
pub(crate) type Followed = (Vec<(f64, &'static str, &'static str)>, [f64; 2]);

/// Follows `arcs` from the first one at t = 0 to `t_end`, looking for ends every `step`.
pub(crate) fn follow(
    arcs: &[Arc<'_>],
    first: usize,
    y: [f64; 2],
    t_end: f64,
    step: f64,
) -> Followed {
    let (mut now, mut t_0, mut y, mut passed) = (first, 0.0, y, Vec::new());
    loop {
        let arc = &arcs[now];
        let at = |t: f64| (arc.motion)(t_0, y, t);
        let left = |end: &End<'_>, t: f64| (end.surface)(t, at(t)) < 0.0;
        let mut low = t_0;
        let found = loop {
            let high = (low + step).min(t_end);
            if let Some(end) = arc.ends.iter().find(|end| left(end, high)) {
                break Some((bisect(low, high, |t| left(end, t)), end));
            }
            if high == t_end {
                break None;
            }
            low = high;
        };
        let Some((t, end)) = found else { return (passed, at(t_end)) };
        let state = at(t);
        passed.push((t, arc.name, arcs[end.next].name));
        (now, t_0, y) = (end.next, t, [end.reset[0] * state[0], end.reset[1] * state[1]]);
    }
}

/// The first number, to the last bit, at which `is_past` holds, where it does not at `low` and does at `high`.
pub(crate) fn bisect(mut low: f64, mut high: f64, is_past: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if is_past(middle) { high = middle } else { low = middle }
    }
}
