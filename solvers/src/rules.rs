//! The rules of events: what is promised in each case, what is not, and what other tools do in that case.
//!
//! # The model
//!
//! - A guard is positive inside its mode. It is *violated* where it is below minus its rounding bound, which the
//!   model states. An event is a violated guard, not a change of sign: there are no direction flags and no cool-down
//!   times.
//! - An event is located at or past the surface, but within rounding of it. Steps of one-step methods end with g between
//!   `−bound` and zero.
//! - One-step methods retake the step from the same start until it lands there, so time and state have the method's
//!   own order. The methods of `diffsol` land on their interpolant, so an event is as exact as that. The error of the
//!   time is (error of the guard + bound)/|ġ|.
//! - A transition returns mode and state. Every guard of the new mode is then evaluated, and one that is violated
//!   switches at the same t. If one is still violated after 16 transitions at one t, or after twice as many as there are
//!   guards where that is more, the run ends in [`Error::Chatter`]. Events [accumulate](crate::System::accumulation)
//!   where 100 in a row, or twice as many as there are guards, lie within 1e-9 of the time since the integration began,
//!   or within 1e-12 of the time from there to the end of the run.
//! - A guard that is violated at the end of a step is always found. A dip inside the step is searched for where the
//!   cubic through values and rates at both ends comes near zero ([`event_location`](crate::event_location)). Guards may move faster than
//!   the states, which alone control the step: `sin(1000 t)` while the states rest. So each phase begins by comparing
//!   the guards with their cubics, and a guard that strays is followed through the step in shorter intervals. None of
//!   4000 sines of 1 to 1000 rad/s with dips of 1e-9 to one of their range was missed by any method, with fixed steps or
//!   by tolerances. The method `taylor` has each guard as a polynomial on the step and isolates its roots by Bernstein
//!   coefficients; where the last terms of the polynomial are not small beside what it shows, it uses the same search.
//!   There is no guarantee for a guard that begins to move fast within a phase, and rests at the ends of the steps. A
//!   guard that cannot be followed, such as noise above its stated bound, is
//!   [`Error::UnresolvedGuard`](crate::Error::UnresolvedGuard).
//! - Cost: one evaluation of the guards with their rates per step, and five more in the first step of a phase. Where a
//!   guard comes near its surface, about fifteen evaluations on the dense output to search for a dip, and those of a
//!   [bracketing search](crate::root) for each guard that falls. For one-step methods, 1.7 to 4.3 retaken steps per
//!   event (measured on [`problems`](crate::problems) at h = 0.25 and rtol = 1e-8).
//!
//! The other tools: **heyoka** 7.12.0 (`doc/tut_events.rst`; where marked †,
//! `src/detail/event_detection.cpp`), whose *terminal* events are those that may change the state;
//! **CVODE** of SUNDIALS 7.5.0 (`doc/cvode/guide/source`: `Mathematics.rst`, "Rootfinding", and
//! `Usage/index.rst`; where marked †, `cvRcheck1` to `cvRootfind` in `src/cvode/cvode.c`); **diffsol**
//! 0.18.0 (`src/nonlinear_solver/root.rs`, `src/ode_solver`, and `root_finding` of diffsol-la 0.3.0),
//! whose root search this crate does not use. All three look for zeros in
//! either direction and have no modes: the user changes parameters or starts anew. heyoka
//! and CVODE can be told a direction, diffsol cannot.
//!
//! The tests are those of `tests/events`, named by file. Each runs over every method of [`METHODS`](crate::METHODS),
//! and leaves out only what its line says.
//!
//! # Where an event may lie
//!
//! **None, or one.** Guards that hold give none, nor do those below zero within their bound; one that
//! crosses gives one. `crossings::no_guard_that_holds_gives_an_event`,
//! `crossings::one_crossing_gives_one_event`,
//! `start::a_guard_below_zero_within_its_rounding_bound_holds`. The others know no bound: heyoka and
//! CVODE report exact zeros and changes of sign, diffsol the same unless the step began at zero.
//!
//! **At t₀, on the surface.** Going in or staying: none. Going out: one, at t₀ to rounding. Violated:
//! a switch before the first step. `start::a_start_on_the_surface_going_in_gives_no_event`,
//! `start::a_start_on_the_surface_going_out_gives_one_event_there`,
//! `start::a_guard_violated_at_the_start_switches_before_the_first_step`.
//! - heyoka: a zero at t₀ is an event†, whichever way it goes, unless on cool-down or of the other
//!   direction.
//! - CVODE: t₀ itself is not reported. A g that is zero there takes its sign from the straight line a
//!   tenth of the first step ahead†; going out is then no event, nor is a return before that.
//! - diffsol: none. The test is `g0 * g1 < 0`, so with `g0 = 0` no crossing in the first step is
//!   seen.
//!
//! **At t₀, leaving the surface as tⁿ.** Rising (`+tⁿ`): none. Falling (`−a tⁿ`): one. One-step
//! methods find it no later than where their `a tⁿ` reaches the bound, which is `(bound/a)^(1/n)` after t₀
//! and not rounding: 6e-8 for n = 2 and 2.4e-4 for n = 4 with a = 1 and a bound of 3.6e-15.
//! `start::a_start_on_the_surface_rising_at_second_order_gives_no_event`,
//! `start::a_start_on_the_surface_rising_at_fourth_order_gives_no_event`,
//! `start::a_start_on_the_surface_rising_at_any_order_gives_no_event`,
//! `start::a_start_on_the_surface_falling_at_second_order_gives_one_event_near_it`,
//! `start::a_start_on_the_surface_falling_at_fourth_order_gives_one_event_near_it`. *Not promised*
//! for diffsol's methods: a falling start is found where `a tⁿ` is within their tolerance (up to
//! 0.55 of it, measured for n = 2 … 8, a = 1e-4 … 1e4 and rtol = 1e-4 … 1e-12).
//! - heyoka: as any zero at t₀; a terminal event with a rate of zero there gets a cool-down of zero†.
//! - CVODE: as above; a g still zero a tenth of a step ahead stays inactive until it is not zero†.
//! - diffsol: as above.
//!
//! **At a step's end.** One event, in this step or the next.
//! `crossings::a_crossing_at_the_end_of_a_step_gives_one_event`.
//! - heyoka: each step looks at [0, h)†, so the next step has it.
//! - CVODE: looks at (t_lo, t_hi], so this step has it; a g that is exactly zero there is then taken
//!   at t + δ.
//! - diffsol: this step has it; the next begins with `g0 = 0` and is blind to that guard.
//!
//! **At t_end.** No event there unless violated: it belongs to the run that goes on.
//! `crossings::a_crossing_at_t_end_belongs_to_the_run_that_goes_on`. heyoka: of [0, h), as above.
//! CVODE: a root at tout is reported. diffsol: a root at the stop time is reported as a root.
//!
//! # Several events
//!
//! **Two guards at one instant.** Both switch, one after the other, the second at the same t or the
//! next landing, rounding apart. *Not promised:* which is first; and there is no second event where
//! the first transition lifts the other guard.
//! `simultaneous::two_guards_at_one_instant_switch_one_after_the_other`,
//! `simultaneous::a_transition_that_lifts_another_violated_guard_cancels_its_event`.
//! - heyoka: the first terminal event in time is taken, those that trigger after it in the step are
//!   discarded; the document does not say which of two at one time is first.
//! - CVODE: one return, with a flag for every g that changes sign in the last bracket†.
//! - diffsol: one index; the sign of the other guard has changed by then, and it may be lost.
//!
//! **Two within the location tolerance.** As at one instant; with 1e-9 between them, in order.
//! `simultaneous::two_guards_within_the_location_tolerance_both_switch_once`,
//! `simultaneous::two_very_close_events_keep_their_order`. CVODE and diffsol: their tolerance is
//! 100 ε (|t| + |h|); CVODE stops with an error where one g is zero both at a root and at δ past it.
//! heyoka: terminal events as above, the rest in order of time.
//!
//! **Many in one step.** All, in order: every event begins a new step.
//! `crossings::twenty_events_in_one_step_come_in_order`. heyoka: non-terminal events in order of
//! time, one terminal event a step. CVODE: in order, one a return, the rest of the step searched at
//! the next call. diffsol: one; the rest of the step is searched only after `state_mut_back`.
//!
//! **The same guard twice in one step.** Found, see above; *not promised* for two dips within an eighth of a step.
//! Methods that retake steps believe a dip only if the retaken step shows it, diffsol's if it is deeper than the error
//! that their tolerance allows; `radau5` looks for deeper ones alone where the guard stays above zero at its stages.
//! `fast::a_guard_that_turns_while_the_states_rest_is_followed`,
//! `fast::dips_of_a_guard_that_turns_while_the_states_rest_are_found`,
//! `stiff_constraint::steps_do_not_shrink_with_the_stiffness_of_a_constraint` (`radau5`),
//! `dips::a_guard_that_falls_and_rises_within_one_step_is_found`,
//! `dips::a_dip_of_the_interpolant_alone_does_not_hide_another_guard` (one-step methods).
//! - heyoka: found, by isolating the real roots of the guard's Taylor polynomial; guards are part of
//!   the step control. CVODE, diffsol: no change of sign between the ends, not found.
//!
//! **A touch without crossing, and a dip that hardly is one.** Where a guard turns within the error of the method of its
//! surface, the run may have an event or none: either may be right. The run goes on, and its recorder is told of a
//! [`Grazing`](crate::Grazing), counted in [`Stats::n_grazing`](crate::Stats::n_grazing) and kept by a
//! [`Trajectory`](crate::Trajectory). It counts each turn that made no event, dips that a retaken step did not show
//! included, and each event whose guard would rise again from within the error, by its curvature at the event. The error is
//! 100 times what the tolerance allows the states in a step, or 100 times the estimated error of a fixed step, and for
//! methods of diffsol as many times as steps were taken if that is more; a guard changes by its derivatives times that, and
//! by its rounding bound. It is found at the first turn of a phase, and anew at one that comes twice as late. What is deeper
//! is an event. Tried on 20 000 draws for each method at tolerances of 1e-6 and 1e-10, with touches and dips of 1e-12 to 1e-3, of
//! guards with sines of 1 to 1000 times the frequency of the states: of 540 000 runs an event was lost or made up in silence in 30
//! (`esdirk34` 18, `tr_bdf2` 9, `rk4` 3; no other method), and a turn was told farther from its surface than three errors by
//! `tsit45` in 602 and by `esdirk34` in 77. A step without a turn near a surface costs no evaluation, an
//! event one right-hand side and two evaluations of the guards, which are not counted. A turn may be told twice, where a dip
//! was discarded. *Not promised:* errors that grow beyond 100 tolerances in a long or unstable run, or by half while the
//! length of a phase doubles; implicit steps of `auto`, for which the error is taken to be a tenth of that; a turn on which
//! the rate is zero to the bit at the end of a step that changes the guard by less than three errors; steps shorter than
//! 1000 roundings of the time; guards whose derivatives are not finite; and
//! [extended precision](crate::taylor::extended), which tells none.
//! `every_event_is_found_or_told_as_grazing`, `cases::a_touch_is_told_also_at_the_end_of_a_step_where_the_rate_is_zero`,
//! `cases::a_shallow_dip_after_a_steep_fall_is_told`, `cases::a_turn_beyond_the_error_is_not_told`,
//! `cases::a_touch_is_told_by_steps_that_are_short_beside_it`, `cases::a_touch_is_told_before_another_guard_falls` of
//! `tests/grazing`,
//! `dips::a_grazing_touch_without_crossing_gives_no_event` (to rounding),
//! `batch::a_guard_that_grazes_in_a_batch_is_told_as_alone`.
//! heyoka: a double root breaks the root finding down, events may be missed, likely with a line in
//! the log. CVODE: "will probably be missed"; an exact zero at an evaluated point is a root. diffsol:
//! likewise.
//!
//! **Observed without switching.** [`Observations`](crate::observe::Observations) record the zeros of any function, rising
//! and falling, without a change of the run. `observing::zeros_are_located_as_exactly_as_the_dense_output_in_both_directions`,
//! `observing::a_run_that_is_observed_has_the_bits_of_one_that_is_not`,
//! `observing::two_zeros_within_one_step_are_found_however_near_to_each_other`,
//! `observing::neither_a_start_on_zero_nor_a_touch_nor_a_jump_is_a_zero`. heyoka: non-terminal events, by the roots of the
//! Taylor polynomial. CVODE, diffsol: every root returns to the caller, who may go on without a new start.
//!
//! # After a switch
//!
//! **A guard that jumps.** It is judged by its new value: positive, it is guarded from there; zero,
//! as a start on the surface; violated, it switches at the same t.
//! `resets::a_guard_that_jumps_at_a_switch_is_judged_by_its_new_value`,
//! `resets::a_reset_onto_the_surface_staying_or_going_in_gives_no_second_event`,
//! `resets::a_reset_onto_the_surface_going_out_switches_again_within_rounding`. In all three others a
//! new negative value is no event: it gives the sign from which the next change is looked for.
//!
//! **A reset and its own guard.** A guard put on its surface does not switch again; left violated it
//! does, at the same t; for ever, it is chatter, and if time advances by rounding, chatter or a
//! storm. `resets::a_reset_does_not_trigger_its_guard_again`,
//! `resets::a_reset_that_leaves_the_new_guard_violated_switches_again_at_once`,
//! `resets::a_reset_that_violates_its_own_guard_for_ever_is_chatter`,
//! `resets::a_reset_onto_the_surface_going_out_for_ever_is_an_error_and_not_a_hang`.
//! - heyoka: a cool-down time, 10 times the error of g over |ġ|†, or given by the user; zeros of that
//!   event within it are ignored.
//! - CVODE: after a new start as at t₀; going on, a g that is exactly zero at a root is taken at
//!   t + δ.
//! - diffsol: g is evaluated anew from the reset state; its book (`primer/bouncing_ball.md`) lifts
//!   the ball to a small positive height lest the event trigger again.
//!
//! **Sticking, sliding, leaving both.** They are modes of the model; a state put on a surface stays
//! there to the bit, and a velocity let go with a rate of zero is not caught again.
//! `sticking::a_mass_that_sticks_stays`, `sticking::a_state_slides_on_a_surface_until_it_is_let_go`,
//! `sticking::a_mass_that_sticks_is_let_go_and_sticks_again`. None of the others has such a mode.
//!
//! **Modes that carry data.** Kept to the bit from the transition to the next one, and seen by the
//! recorder. `modes::a_mode_carries_what_its_entry_stored`. Others: parameters of the right-hand
//! side. An error of chatter tells whether one mode violates its own guard, whatever it carries then,
//! or modes hand over to each other: `modes::a_mode_that_carries_data_and_violates_itself_is_told_as_one`,
//! `modes::two_values_that_a_mode_carries_in_turn_are_told_as_two_modes`.
//!
//! **Events that accumulate, and chatter.** At a Zeno point the run goes on in the limiting mode, if
//! the model [names one](crate::System::accumulation): a ball comes to rest. Else an error, not a
//! hang. A method of diffsol does not resolve arcs lower than the error of a step, and may make up what
//! follows: each fall that ends one is told as a [`Grazing`](crate::Grazing), true or not, so that an accumulation with
//! none is true. The height of an arc is that of a parabola with the rates at its ends. By `bdf` at 1e-8 a ball
//! rests 3.8e-5 s early, after 120 events of which 105 are told; those before are off by 4.0e-6 s. *Not promised:* that spurious events of a loose
//! tolerance are told from true ones by the other methods.
//! `bounces_too_low_to_resolve_are_told` of `tests/grazing`, `accumulation::a_ball_whose_bounces_accumulate_comes_to_rest`,
//! `accumulation::bounces_end_though_the_rounding_bound_grows_with_the_speed`,
//! `accumulation::events_that_accumulate_to_no_limit_are_an_event_storm`,
//! `accumulation::transitions_that_undo_each_other_in_one_mode_are_told_from_modes_that_hand_over`,
//! `accumulation::two_modes_that_hand_over_without_moving_are_chatter`,
//! `accumulation::two_modes_that_push_against_each_other_are_an_error_and_not_a_hang`. The documents
//! of the others name no such rule.
//!
//! # Guards of other kinds, and ends
//!
//! **Zero throughout.** No event, in one mode or in all.
//! `crossings::a_guard_that_is_zero_throughout_gives_no_event`,
//! `crossings::a_guard_that_is_zero_in_one_mode_leaves_the_others_alive`. heyoka: an event at the
//! beginning of each step†. CVODE: inactive, with a warning after the first step. diffsol: a root at
//! the end of each step.
//!
//! **Not written, not bounded.** A guard that the model does not write in a mode, and a rounding bound that is not above
//! zero, are errors where the mode is entered. `refused::a_guard_that_is_never_written_is_refused`,
//! `refused::a_rounding_bound_that_is_not_above_zero_is_refused`.
//!
//! **Not finite.** NaN or infinite at the start is [`Error::NonFiniteGuard`]. At a step's end or a landing
//! it shortens the step, under adaptive control of a one-step method, and is that error where the step can be no
//! shorter; a fixed step, and a method of diffsol, end there, also if another guard falls earlier in that step.
//! *Not promised:* that one which is not finite only inside a
//! step is seen. `not_finite::a_guard_that_is_not_a_number_is_an_error_that_names_the_place`,
//! `not_finite::a_guard_that_is_infinite_is_an_error_that_names_the_place`,
//! `not_finite::a_step_beyond_where_a_guard_is_a_number_is_shortened`. heyoka: detection
//! may be skipped without a warning; its source says that the step catches it†. CVODE: no test for
//! it†; a root function may return a failure, which stops the run. diffsol: `g0 * g1 < 0` is
//! false for NaN: no root, no message.
//!
//! **Terminal.** [`Next::Stop`](crate::Next::Stop) ends the run at the event, as an outcome.
//! `crossings::a_terminal_event_stops_the_run`. heyoka: a callback that returns false. CVODE,
//! diffsol: every root returns to the caller (diffsol's `solve` goes on where a reset is given).
//!
//! **Broken off by a recorder.** After a step that lands on an event its transition is still made, so the run that goes on
//! begins in the next mode; events accumulate over the runs of one integration.
//! `recorder::a_run_that_is_broken_off_at_each_landing_passes_its_events`,
//! `recorder::a_run_that_is_broken_off_at_each_event_comes_to_rest`.
//!
//! **Backward in time.** The same rules; inside stays positive, whichever way time runs.
//! `backward::events_are_located_backward_in_time`,
//! `backward::a_start_on_the_surface_counts_the_same_backward`,
//! `backward::a_reset_does_not_trigger_its_guard_again_backward`,
//! `backward::a_guard_that_falls_and_rises_within_one_step_is_found_backward`. heyoka: in reverse
//! order of time. CVODE: "in the direction of integration". diffsol: its search works with |t|, not
//! tried here.
//!
//! [`Error::Chatter`]: crate::Error::Chatter
//! [`Error::NonFiniteGuard`]: crate::Error::NonFiniteGuard
