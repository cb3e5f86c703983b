//! The motion of a slider-crank as CSV.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::exact;
use crate::run::JointHistory;
use crate::study::motion::SliderRow;

/// `trajectory.csv` of a slider-crank: the pin in its bush (d1 along the slider's way, d2 across it), the
/// angles of crank and rod, the slider's place, their rates, the slider's acceleration and that without
/// clearance, the forces of the contact, and the torque that holds the crank's speed.
pub(super) fn trajectory_csv(out: &mut dyn Write, joints: &[&JointHistory<'_>]) -> io::Result<()> {
    writeln!(
        out,
        "bay,joint,t_s,mode,d1_m,d2_m,crank_rad,rod_rad,slider_m,v1_m_s,v2_m_s,crank_rad_s,rod_rad_s,\
         slider_m_s,slider_m_s2,ideal_slider_m_s2,f_n_n,f_t_n,torque_n_m"
    )?;
    for JointHistory { bay, block, samples, .. } in joints {
        for sample in samples {
            let Some(slider) = block.slider(sample.mode, &sample.y, sample.forces) else {
                continue;
            };
            let [d1, d2, theta, v1, v2, omega] = sample.y;
            // A diverging state may be finite where its forces are not.
            let finite = |x: f64| exact(x.is_finite().then_some(x));
            let columns = [
                d1,
                d2,
                theta,
                slider.phi,
                slider.place,
                v1,
                v2,
                omega,
                slider.phi_dot,
                slider.velocity,
                slider.acceleration,
                slider.ideal_acceleration,
                sample.forces.normal,
                sample.forces.tangential,
                slider.torque,
            ];
            let (joint, t, mode) = (block.joint, sample.t, sample.mode.code());
            let columns = columns.map(finite).join(",");
            writeln!(out, "{bay},{joint},{t:e},{mode},{columns}")?;
        }
    }
    Ok(())
}

/// `slider.csv`: what the figure of the slider's acceleration shows.
pub fn slider_csv(rows: &[SliderRow]) -> String {
    let mut csv = String::from("t_s,crank_rad,slider_m_s2,ideal_slider_m_s2\n");
    for SliderRow { t_s, crank_rad, slider_m_s2, ideal_m_s2 } in rows {
        let _ = writeln!(csv, "{t_s:e},{crank_rad:e},{slider_m_s2:e},{ideal_m_s2:e}");
    }
    csv
}
