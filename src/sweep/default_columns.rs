//! The columns that a report is of where none are named: those that answer what is asked of a contact.

use super::results::Results;

/// Most of them.
const MOST: usize = 6;
/// What is asked, each a column of all sites, and where there are several one of each site.
const ASKED: [&str; 6] =
    ["peak_force_n", "n_contacts", "impulse_n_s", "dissipated_j", OF_ALL[0], OF_ALL[1]];
/// What a run may have whatever it is of: its estimated error and its work.
const OF_ALL: [&str; 2] = ["estimated_e", "n_rhs"];
/// What stands before the states of a site, and what comes after those of the last.
const TIME: &str = "t_s";
const MODE: &str = "mode";
const EVENTS: &str = "n_events";

/// Those of peak force, contacts, impulse, dissipation, estimated error and work that the sweep has. Each site's own are in the
/// place of those of all, in their order, as long as there are no more than six in all. A sweep that tells of neither contacts
/// nor energy has the states at the end before the rest.
pub fn default_columns(results: &Results) -> Vec<&str> {
    of(&results.columns)
}

fn of(all: &[String]) -> Vec<&str> {
    let has = |name: &&str| all.iter().any(|own| own == name);
    let asked: Vec<&str> = ASKED.into_iter().filter(has).collect();
    let prefixes = prefixes(all);
    if asked.iter().all(|name| OF_ALL.contains(name)) {
        let states = states(all, &prefixes).into_iter().take(MOST - asked.len());
        return states.chain(asked).collect();
    }
    let of_sites = |name: &str| -> Vec<&str> {
        let own = |prefix: &&str| all.iter().find(|own| **own == format!("{prefix}{name}"));
        prefixes.iter().filter_map(own).map(String::as_str).collect()
    };
    let (mut columns, mut left) = (Vec::new(), asked.len());
    for name in asked {
        left -= 1;
        let own = of_sites(name);
        if own.len() > 1 && columns.len() + own.len() + left <= MOST {
            columns.extend(own);
        } else {
            columns.push(name);
        }
    }
    columns
}

/// What stands before the columns of each site: those of its time and mode follow each other.
fn prefixes(columns: &[String]) -> Vec<&str> {
    fn prefix(pair: &[String]) -> Option<&str> {
        let [time, mode] = pair else { return None };
        let prefix = time.strip_suffix(TIME)?;
        (mode.strip_prefix(prefix) == Some(MODE)).then_some(prefix)
    }
    columns.windows(2).filter_map(prefix).collect()
}

/// The states and observables at the end of each site, which stand between its mode and the counts of events.
fn states<'a>(columns: &'a [String], prefixes: &[&str]) -> Vec<&'a str> {
    let place = |name: &str| {
        let own = prefixes.first().map(|prefix| format!("{prefix}{name}"));
        columns.iter().position(|column| Some(column) == own.as_ref()).unwrap_or_default()
    };
    let is_other = |column: &&str| {
        [TIME, MODE]
            .iter()
            .any(|name| column.strip_suffix(name).is_some_and(|prefix| prefixes.contains(&prefix)))
    };
    let told = columns.get(place(TIME)..place(EVENTS)).unwrap_or_default();
    told.iter().map(String::as_str).filter(|column| !is_other(column)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(names: &str) -> Vec<String> {
        let columns: Vec<String> = names.split(' ').map(str::to_owned).collect();
        of(&columns).into_iter().map(str::to_owned).collect()
    }

    #[test]
    fn one_site_has_what_is_asked_of_it() {
        let names = "run K status outcome t_s mode x_m n_events n_contacts peak_force_n impulse_n_s work_j dissipated_j n_rhs";
        let expected = ["peak_force_n", "n_contacts", "impulse_n_s", "dissipated_j", "n_rhs"];
        assert_eq!(chosen(names), expected);
    }

    #[test]
    fn sites_have_their_own_as_long_as_six_are_enough() {
        let sites = "run status outcome a1_t_s a1_mode a1_x_m a2_t_s a2_mode a2_x_m";
        let own =
            "a1_n_events a1_n_contacts a1_peak_force_n a2_n_events a2_n_contacts a2_peak_force_n";
        let all = "n_events n_contacts peak_force_n dissipated_j n_rhs";
        let found = chosen(&format!("{sites} {own} {all}"));
        let expected = [
            "a1_peak_force_n",
            "a2_peak_force_n",
            "a1_n_contacts",
            "a2_n_contacts",
            "dissipated_j",
            "n_rhs",
        ];
        assert_eq!(found, expected);
        let found = chosen(&format!("{sites} {own} {all} estimated_e"));
        let expected = [
            "a1_peak_force_n",
            "a2_peak_force_n",
            "n_contacts",
            "dissipated_j",
            "estimated_e",
            "n_rhs",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn without_contacts_it_is_the_states_at_the_end() {
        assert_eq!(
            chosen("run K status outcome t_s mode x_m v n_events n_rhs"),
            ["x_m", "v", "n_rhs"]
        );
        let two = "run status outcome a1_t_s a1_mode a1_x_m a2_t_s a2_mode a2_x_m a1_n_events a2_n_events n_events n_rhs";
        assert_eq!(chosen(two), ["a1_x_m", "a2_x_m", "n_rhs"]);
        let checked = "run status outcome t_s mode x_m v n_events n_rhs horizon_s estimated_e";
        assert_eq!(chosen(checked), ["x_m", "v", "estimated_e", "n_rhs"]);
        let many = "run status outcome t_s mode a b c d e f g n_events n_rhs";
        assert_eq!(chosen(many), ["a", "b", "c", "d", "e", "n_rhs"]);
    }
}
