//! The laws of contact with what they deliver, as text and as JSON.

use serde_json::{Value, json};

use crate::laws::ContactLaw;
use crate::study::friction::{Cost, METHODS, RTOL, T_END};
use crate::study::restitution::{Delivery, NEAR, requested};

const HEAD: &str = "\
# Laws of contact and friction

Made by `deltazero laws`.

## Normal laws

Penetration δ [m], its rate δ̇ [m/s], normal force F_N [N]. A law is an elastic part and a loss:

```text
F_N = F(δ) + D δ̇                    loses D δ̇²            [W]
F_N = F(δ) (1 + χ δ̇/δ̇₋)             loses F χ δ̇²/δ̇₋       [W],  χ and e without unit
```

`F = K δⁿ` where nothing else is said (K in N/mⁿ; n = 1.5 is Hertz's). δ̇₋ is the speed at which the contact began, at least
`contact.impact_speed_floor`; a contact that begins slower counts in `n_at_speed_floor` of `run.json`. A law with χ uses
`contact.restitution` in place of `contact.damping`; a law of cylinders `young_modulus`, `poisson_ratio`, `length` (but the last) and
`curvature` in place of `stiffness` and `exponent`. Pin and bush are of one material:

```text
k = 2(1 − ν²)/(π E)   1/E* = π k   R₁ pin, R₂ = R₁ + c bush, L length of the contact
internal: ΔR = R₂ − R₁   external: ΔR = R₁ + R₂   R = R₁R₂/ΔR
```

`δ = (k/L) F (ln(B/F) ± 1)` has a turning point, `F* = B e^(±1 − 1)`, beyond which it means nothing: a run ends with an error where
ln(C/F) = 1.1, C = B e^(±1), that is at 0.905 F* and 0.9953 δ*; before it starts, if the drive alone asks for more.

Sources differ by a factor π in Goldsmith's family (dubowsky_freudenstein, johnson, esdu_78035): k with π in its denominator, as
here and in Johnson's derivation, or (1 − ν²)/E without; a program in use has the latter, and another π before esdu_78035.
The constants were checked against other programs and the derivation above, esdu_78035 and liu against one program alone.

";

/// All of it as Markdown.
pub fn markdown(deliveries: &[Delivery], costs: &[Cost]) -> String {
    let mut out = HEAD.to_owned();
    out += "| law | equation | remark | source |\n|---|---|---|---|\n";
    for ContactLaw { word, equation, source, remark, .. } in ContactLaw::ALL {
        out += &format!("| `{word}` | {equation} | {remark} | {source} |\n");
    }
    out += "\n## Requested and delivered restitution\n\n\
        A free impact, simulated; what is delivered follows from χ(1 + e') = ln[(1 + χ)/(1 − χe')], whatever K, n, mass and \
        speed.\n\n| e |";
    for delivery in deliveries {
        out += &format!(" {} |", delivery.law);
    }
    out += &format!("\n|---{}|\n", "|---".repeat(deliveries.len()));
    for (i, e) in requested().enumerate() {
        out += &format!("| {e:.2} |");
        for delivery in deliveries {
            out += &format!(" {:.4} |", delivery.impacts[i].delivered);
        }
        out += "\n";
    }
    out +=
        &format!("\nNot to be used where the delivered restitution is more than {NEAR} off:\n\n");
    for delivery in deliveries {
        let law = delivery.law;
        out += &match delivery.near_from {
            Some(e) if Some(e) == requested().next() => {
                format!("- `{law}`: near at every e asked\n")
            }
            Some(e) => format!("- `{law}`: below e = {e:.2}\n"),
            None => format!("- `{law}`: anywhere\n"),
        };
    }
    out + &friction(costs)
}

const FRICTION: &str = "
## Friction

`F_T = −σ m(s) F_N`, σ the sign of the tangential velocity v_T [m/s] and s = |v_T|. `coulomb` m = μ and `stribeck`
m = μ + (μ_s − μ) exp(−(s/v_S)²) stick at s = 0 while both slips lead back there: |F_T| < m(0) F_N, or < −m(0) F_N
where the contact pulls and friction is a torque alone (the reading `pin`) that moves the pin against its turning. These rise from m(0) = 0 over v_r
(`friction.regularisation_speed`) instead, and creep where those stick:

| law | m(s) | pieces, each a mode |
|---|---|---|
| `tanh` | μ tanh(s/v_r) to 19 v_r, μ beyond | two |
| `ambrosio` | 0 to v_0, μ (s − v_0)/(v_r − v_0) to v_r, μ beyond; v_0 = `dead_ratio` v_r | three |
| `threlfall` | μ (1 − exp(−3 s/v_r)) to v_r, μ (1 − e⁻³) beyond (printed as 0.95 μ) | two |

`threlfall` does not tend to `coulomb` with v_r: its limit is 0.95 μ.

Where these have settled to a rounding error, `tanh` at 19 v_r and the Gaussian of `stribeck` and `lugre` at 6 v_S, they are constant: what they do
below is a piece that starts with an event. Left smooth, it is too narrow for a method of high order to see from afar, at any tolerance: all
terms of the Gaussian's series at 30 v_S are zero.

`lugre` bends bristles before they slide. Their deflection z [m] is a seventh state of the joint, zero where a contact begins:

```text
F_T = −F_N (σ_0 z + σ_1 ż + σ_2 v_T),   ż = v_T − σ_0 |v_T| z/g(|v_T|),   g(s) = μ + (μ_s − μ) exp(−(s/v_S)²)
```

It has no stick: what sticks elsewhere bends its bristles here, by |z| ≤ max g/σ_0, and may creep on under a load that oscillates.
Each change of the sign of v_T, where ż has a kink, is an event. Where bristles are unbent and v_T is above μ_s/σ_1 (15 mm/s by default), as where a
contact begins fast, F_T exceeds μ_s F_N; and σ_1 may give energy back where v_T falls from one speed to another with less friction: for a
constant F_N the law is passive if σ_2 ≥ σ_1 (μ_s − μ)/μ. C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, IEEE Trans. Autom.
Control 40(3), 419–425 (1995), where σ_0 z is a force, up to F_C for μ; F_N as a factor by C. Canudas de Wit, P. Tsiotras, Proc. 38th
IEEE CDC (1999). For located events, in f64.

## What regularising costs, and what error it brings

";

fn friction(costs: &[Cost]) -> String {
    let [explicit, implicit] = METHODS;
    let mut out = format!(
        "{FRICTION}Table 1 in the reading `full` to {T_END} s at rtol {RTOL:e}: right-hand sides of {explicit} and {implicit}, \
         events, and the error e against `coulomb`; \
         of `lugre` with μ_s = μ.\n\n\
         | law | v_r [m/s] or σ_0 [1/m] | n_rhs {explicit} | n_rhs {implicit} | events | e |\n|---|---|---|---|---|---|\n"
    );
    for cost in costs {
        let softness = cost.softness.speed.or(cost.softness.stiffness);
        let softness = softness.map_or_else(String::new, |softness| format!("{softness:e}"));
        let n = cost.n_rhs.map(|n| n.map_or_else(|| "failed".to_owned(), |n| n.to_string()));
        let Cost { law, n_events, e, .. } = cost;
        out += &format!("| `{law}` | {softness} | {} | {} | {n_events} | {e:.1e} |\n", n[0], n[1]);
    }
    out
}

/// All of it as JSON.
pub fn json(deliveries: &[Delivery], costs: &[Cost]) -> Value {
    let law = |law: &ContactLaw| {
        let delivery = deliveries.iter().find(|delivery| delivery.law == law);
        json!({
            "law": law,
            "equation": law.equation,
            "source": law.source,
            "remark": law.remark,
            "has_memory": law.has_memory(),
            "impacts": delivery.map(|delivery| &delivery.impacts),
            "near_from": delivery.and_then(|delivery| delivery.near_from),
        })
    };
    json!({ "normal": ContactLaw::ALL.iter().map(law).collect::<Vec<_>>(), "friction": costs })
}
