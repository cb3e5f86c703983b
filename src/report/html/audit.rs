//! The page of an audit: claims, what follows, figures, runs, torque ratios, how to redo it.

use deltazero_study::columns::Value;
use deltazero_study::digits::rounded_to;

use super::{Heading, Page, Part, Section, Table};
use crate::config::Config;
use crate::figures::Picture;
use crate::paper::audit::Audit;
use crate::paper::claims::{CLAIMS, ClaimRow};
use crate::report::audit::{
    DIGITS, IDEAL_COLUMNS, RATIO_COLUMNS, RUN_COLUMNS, RUN_NOTE, VAGUE, findings, ideal_lines,
    ratio_lines, run_lines,
};

/// The page of an audit with its figures.
pub fn page(config: &Config, audit: &Audit, pictures: Vec<Picture>) -> Page {
    let section = |title: &str, parts| Section { title: title.into(), parts };
    let claims = CLAIMS.iter().map(|claim| {
        let what = format!("{} Measured: {}.", claim.says, claim.measure);
        (claim.name.to_owned(), what)
    });
    Page {
        title: "The paper, claim by claim".into(),
        lead: "What \"Dynamic Analysis of Deployable Strut-Mechanism with Clearance Root-Joints\" says of its \
               deployment, and what comes out under each reading of its equations: reproduced, not \
               reproduced, or impossible."
            .into(),
        sections: vec![
            section("What follows", findings(config, audit).into_iter().map(Part::Text).collect()),
            section(
                "Claims",
                vec![
                    claim_table(&audit.rows),
                    Part::Text(format!(
                        "Reproduced: within 2 % of the paper's figure, equal in the digits that it prints, \
                         or by the rule of the claim. ~: {VAGUE}. Ideal: without clearance."
                    )),
                    Part::Folded("What is claimed, and what is measured".into(), vec![Part::Facts(claims.collect())]),
                ],
            ),
            section("Figures", pictures.into_iter().map(Part::Figure).collect()),
            section(
                "Runs",
                vec![
                    lines(&format!("Every run to 90°, {}", audit.method), &RUN_COLUMNS, run_lines(audit)),
                    Part::Text(RUN_NOTE.into()),
                    lines("Without clearance: by quadrature and by an integrator", &IDEAL_COLUMNS, ideal_lines(audit)),
                ],
            ),
            section(
                "Torque ratio",
                vec![lines(
                    &format!("M1 = {} N m, M4 so that both struts reach 90° together", audit.torque_ratio.m1),
                    &RATIO_COLUMNS,
                    ratio_lines(audit),
                )],
            ),
            section(
                "Redo it",
                vec![
                    Part::Text("With the configuration below as audit.toml; every number comes out the same:".into()),
                    Part::Code("deltazero audit audit.toml --out redone".into()),
                    Part::Folded("The configuration".into(), vec![Part::Code(config.to_toml())]),
                ],
            ),
        ],
    }
}

fn heading(name: &str) -> Heading {
    Heading { name: name.into(), about: String::new() }
}

fn claim_table(rows: &[ClaimRow]) -> Part {
    let cells = |row: &ClaimRow| {
        vec![
            Value::Text(row.claim.clone()),
            Value::Text(row.reading.clone()),
            Value::Number(row.paper),
            Value::Number(row.measured.map(|x| rounded_to(x, row.digits(DIGITS)))),
            Value::Text(row.unit.clone()),
            Value::Text(row.verdict.name().replace('_', " ")),
            Value::Number(row.horizon_s),
            Value::Text(if row.beyond_horizon { "~" } else { "" }.into()),
        ]
    };
    let columns = [
        "claim",
        "reading",
        "paper",
        "measured",
        "unit",
        "verdict",
        "digits lost from [s]",
        "beyond the horizon",
    ];
    Part::Table(Table {
        caption: "Each claim under each reading; the paper's figure is empty where it speaks in words, the \
                  measured one where it never happens or is not defined"
            .into(),
        columns: columns.map(heading).into(),
        rows: rows.iter().map(cells).collect(),
    })
}

fn lines(caption: &str, columns: &[&str], lines: Vec<Vec<String>>) -> Part {
    let row = |line: Vec<String>| line.into_iter().map(Value::Text).collect();
    Part::Table(Table {
        caption: caption.into(),
        columns: columns.iter().map(|name| heading(name)).collect(),
        rows: lines.into_iter().map(row).collect(),
    })
}
