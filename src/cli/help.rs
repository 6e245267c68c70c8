//! Longer parts of the help.

use std::fmt::Write;

use crate::integrator;
use crate::scene::options::{OptionReader, Options};

/// Below the list of commands.
pub(super) const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 crosscheck found a real disagreement, 2 wrong use, 3 broken scene, 4 a file cannot be read or written, or a program
that bench races failed, 5 too little memory, 70 a bug of ours, 130 stopped by Ctrl-C, 143 stopped by SIGTERM.";

/// Below the short help of `render`.
pub(super) const RENDER_EXAMPLES: &str = "\
Examples:
  lumiflow render cornell.xml --spp 256 -o cornell.exr -o cornell.png
  lumiflow render cornell.xml --time 60 --aov albedo,sh_normal,variance --json
  lumiflow render */scene.xml -o 'out/{name}.exr' -i path --set max_depth=8

Ctrl-C writes what is rendered so far, in whole passes; a second one ends at once.
`lumiflow help render` lists the integrators with their options.";

/// Below the help of `convert`.
pub(super) const CONVERT_EXAMPLES: &str = "\
Examples:
  lumiflow convert cornell.exr cornell.png --exposure 1.5
  lumiflow convert cornell.exr albedo.png --layer albedo";

/// Below the help of `compare`.
pub(super) const COMPARE_EXAMPLES: &str = "\
Prints MSE, relMSE = mean((I-R)^2 / (R^2 + 0.01)), the ratio of the means and FLIP. With the
variance of both images it adds what the noise of the reference puts into relMSE, the standard
error of the ratio, and z-scores of tiles: noise alone gives a mean z^2 of 1.

Examples:
  lumiflow compare cornell.exr reference.exr
  lumiflow compare cornell.exr reference.exr --variance cornell.exr \\
      --reference-variance reference_var.exr --mask lights.png -o error.png";

/// Below the help of `bench`.
pub(super) const BENCH_EXAMPLES: &str = "\
Renders each scene with each integrator, budget and seed, and prints tables. The constant in them is
that of efficiency, (relMSE - the reference's noise) x CPU seconds: for an unbiased integrator it
does not depend on the budget; lower is better. Nothing else should run on the machine.

Examples:
  lumiflow bench scenes/*/scene.xml --time 5,20 --seeds 5 -o bench
  lumiflow bench box.xml -i path,direct --set path.max_depth=2 --spp 64 --reference box-ref.exr
  lumiflow bench box.xml -i erpt,erpt:mutations_per_sample=3 --cpu 5,20,80 -o bench
  lumiflow bench box.xml -i path --time 20 -o bench \\
      --peer 'other=other-renderer --time {seconds} --seed {seed} -o {out} {scene}'

Ctrl-C ends the render under way and prints what is complete; a second one ends at once. With -o, the
same call goes on where it was interrupted.";

/// Below the help of `crosscheck`.
pub(super) const CROSSCHECK_EXAMPLES: &str = "\
Aims rays of nine kinds at the scene's own geometry and asks Embree and the tree of obvhs for the
closest hit and for any hit. Where they disagree, a referee in double precision says whether it is a
tie, a silhouette, a limit of single precision, or real: an answer that cannot be right. The exit code is 1 when something real
was found. docs/crosscheck.md says what is compared, and how closely.

Examples:
  lumiflow crosscheck cornell.xml --rays 1000000 --json
  lumiflow crosscheck cornell.xml --replay 1042/edge
  lumiflow crosscheck cornell.xml --ray 0,1,4,0,0,-1,0,inf";

/// What the options of the integrators mean.
const OPTIONS: &[(&str, &str)] = &[
    (
        "max_depth",
        "longest path in edges; 1 shows lights only, -1 is no limit",
    ),
    (
        "rr_depth",
        "edges from which on Russian roulette may end a path",
    ),
    ("hide_emitters", "lights and sky do not show themselves"),
    (
        "strict_normals",
        "no light where true and shading normal disagree",
    ),
    (
        "mis",
        "weights of sampling techniques: balance, power or maximum",
    ),
    (
        "mis_power",
        "exponent of mis=power: 1 is balance, 2 the usual one",
    ),
    (
        "light_image",
        "connect light paths to the lens, too (Mitsuba: lightImage)",
    ),
    (
        "sample_direct",
        "sample lights from camera paths, not take the start of the light path (Mitsuba: sampleDirect)",
    ),
    (
        "connection_roulette",
        "drop most connections that would bring less than this share of the mean luminance; 0 makes all",
    ),
    (
        "technique_edges",
        "longest paths whose techniques have layers of their own with --aov techniques, in edges",
    ),
    (
        "shading_samples",
        "sets emitter_samples and bsdf_samples at once",
    ),
    (
        "emitter_samples",
        "directions to lights for each camera sample",
    ),
    (
        "bsdf_samples",
        "directions of the material for each camera sample",
    ),
    (
        "chain_length",
        "mutations of a chain, m (Mitsuba: chainLength)",
    ),
    ("population", "most paths that are alive at once, N"),
    ("mutations", "mutations of a path in a round, m"),
    ("rounds", "rounds that each path lives, J"),
    (
        "scheme",
        "fixed: all paths live J rounds; lai: as long as their energy lasts, as published: biased",
    ),
    (
        "transfer",
        "how paths spread energy: deposits, or balance (their proposals become paths themselves)",
    ),
    (
        "resampling_rate",
        "part of the population that is replaced after each round",
    ),
    (
        "radii",
        "sizes of moves on the image, in pixels: one or more, as 5,10,50 or 5/10/50",
    ),
    (
        "caustic_share",
        "chance of a caustic move where one applies; others share the rest",
    ),
    (
        "adaptation",
        "how radii are chosen: map (learnt in passes before), member (own past: biased) or off",
    ),
    ("map_cell", "side of the map's cells in pixels"),
    ("epsilon", "chance that every radius keeps, however poor"),
    (
        "reach_power",
        "a radius counts by its mean acceptance times itself to this power",
    ),
    (
        "proposal_density",
        "density in the acceptance: of the kernel that made the proposal, or of the mixture",
    ),
    (
        "max_members",
        "most paths that one seed begins; beyond, each has more weight",
    ),
    (
        "num_chains",
        "chains for each camera sample in the mean, sets K to that times m where K is not given; 0 leaves K (Mitsuba: numChains)",
    ),
    (
        "mutations_per_sample",
        "mutations for each camera sample in the mean, K: sets the energy of a deposit",
    ),
    (
        "deposition_energy",
        "energy of a deposit as luminance; 0 estimates it",
    ),
    (
        "luminance_samples",
        "camera samples to estimate deposition_energy from (erpt, pmc-er; 0: four a pixel), or to draw a pass's seeds from (0: one a pixel) (Mitsuba: luminanceSamples)",
    ),
    ("mutations_per_pixel", "mutations for each pixel in a pass"),
    (
        "chains",
        "chains of a pass; 0 makes each about a thousand mutations long",
    ),
    (
        "noise_aware",
        "draw chains to where passes before were noisy",
    ),
    (
        "bidirectional",
        "samples from both sides instead of path-traced ones (Mitsuba: bidirectional)",
    ),
    (
        "p_large",
        "chance of a large step, which takes fresh numbers (Mitsuba: pLarge)",
    ),
    (
        "step_smallest",
        "smallest distance of a number's small step",
    ),
    ("step_largest", "largest distance of a number's small step"),
    (
        "target",
        "importance of a state: light of the whole camera sample, or of one path of it",
    ),
    (
        "deposits",
        "expected values alone (all there is where target is path), or weighed against large steps",
    ),
    (
        "max_chains",
        "most chains of one path; beyond, deposits grow; 0 is the default (Mitsuba: maxChains)",
    ),
    (
        "flow",
        "how energy flows: equal (deposition), detailed or iterated (detailed balance)",
    ),
    (
        "expected_values",
        "equal deposition at both states of a step, not only where it ends",
    ),
    (
        "flow_proposals",
        "proposals of each application of iterated detailed balance",
    ),
    (
        "flow_depth",
        "how often detailed balance is applied to its own results",
    ),
    (
        "seeds",
        "where paths come from: path (path tracing) or bdpt (each connection of subpaths from both sides)",
    ),
    (
        "separate_direct",
        "light of one bounce by path tracing, in a layer of its own",
    ),
    (
        "direct_samples",
        "samples a pixel and pass for the layer direct; erpt, pmc-er: beside the seeds' own (Mitsuba: directSamples; -1: no such layer)",
    ),
    (
        "mutation_choice",
        "rule takes one by the kind of path, mixture any that applies",
    ),
    (
        "lens_perturbation",
        "mutation: move paths on the image (Mitsuba: lensPerturbation)",
    ),
    (
        "multi_chain_perturbation",
        "mutation: move, and turn directions before mirrors and glass (Mitsuba: multiChainPerturbation)",
    ),
    (
        "lai_lens_perturbation",
        "mutation: move, and keep the mirror or glass behind a diffuse surface",
    ),
    (
        "caustic_perturbation",
        "mutation: turn light before it reaches what is seen (Mitsuba: causticPerturbation)",
    ),
    (
        "bidirectional_mutation",
        "mutation: take a piece out and put another in (Mitsuba: bidirectionalMutation)",
    ),
    (
        "bidirectional_weight",
        "weight of the mutation beside those of one kind of path",
    ),
    ("lens_weight", "weight of the mutation where several apply"),
    (
        "multi_chain_weight",
        "weight of the mutation where several apply",
    ),
    (
        "lai_lens_weight",
        "weight of the mutation where several apply",
    ),
    (
        "caustic_weight",
        "weight of the mutation where several apply",
    ),
    (
        "lens_shape",
        "moves on the image: uniform in a square or disk, or with a uniform logarithm (log)",
    ),
    (
        "lens_size",
        "side of the square, radius of the disk, largest distance; in pixels",
    ),
    ("lens_smallest", "smallest distance of log, in pixels"),
    (
        "lens_aperture",
        "largest move on a thin lens, in radii of it",
    ),
    ("angle_smallest", "smallest angle of turns, in radians"),
    ("angle_largest", "largest angle of turns, in radians"),
    (
        "caustic_pixels",
        "uniform caustic moves of so many pixels; 0 takes turns as elsewhere",
    ),
    (
        "proposal_filter",
        "biased, in layer filtered: even out numbers of proposals by box, median or luminance",
    ),
    (
        "proposal_filter_size",
        "side of proposal_filter's neighbourhood in pixels, odd",
    ),
    (
        "consecutive_limit",
        "biased, in layer filtered: drop energy after so many steps on one pixel; 0 is off",
    ),
];

/// The integrators with their options and defaults, and the examples.
pub(super) fn integrators() -> String {
    let mut text = "Integrators (-i), and their options (--set) with defaults:\n".to_owned();
    for (name, about) in integrator::NAMES {
        let _ = writeln!(text, "\n  {name}: {about}");
        for (option, default) in defaults(name) {
            let meaning = OPTIONS.iter().find(|(known, _)| *known == option);
            let meaning = meaning.map_or("", |(_, meaning)| meaning);
            let _ = writeln!(text, "    {:<31} {meaning}", format!("{option}={default}"));
        }
    }
    let _ = write!(text, "\n{RENDER_EXAMPLES}");
    text
}

/// Options of an integrator with their defaults, as it asks for them itself.
fn defaults(name: &str) -> Vec<(String, String)> {
    let none = Options::new();
    let mut reader = OptionReader::new(&none);
    // Defaults are in range, so that this cannot fail; what was asked for shows either way.
    let _ = integrator::from_options(name, &mut reader);
    let pairs = reader.used().iter();
    pairs
        .map(|(option, default)| (option.clone(), default.to_string()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_is_explained_and_none_is_invented() {
        let asked: Vec<String> = integrator::NAMES
            .iter()
            .flat_map(|(name, _)| defaults(name))
            .map(|(option, _)| option)
            .collect();
        for option in &asked {
            assert!(OPTIONS.iter().any(|(known, _)| known == option), "{option}");
        }
        for (option, _) in OPTIONS {
            assert!(asked.iter().any(|known| known == option), "{option}");
        }
    }

    #[test]
    fn defaults_are_listed() {
        let text = integrators();
        for part in [
            "max_depth=-1",
            "rr_depth=5",
            "hide_emitters=false",
            "mis=power",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
}
