//! Where errors are planted.

use lumiflow::mutation::{Fault, Mutation};

/// A fault, where it is planted, and what it should show in.
pub(crate) struct Planted {
    pub(crate) fault: Fault,
    /// Name of the stage.
    pub(crate) stage: &'static str,
    pub(crate) mutation: Mutation,
    /// Whether only caustics are mutated.
    pub(crate) is_caustic: bool,
    /// Camera samples.
    pub(crate) samples: u32,
    /// The function of a path that is the fault's own.
    pub(crate) own: &'static str,
}

const TABLE: &str = "
fault              | stage          | mutation    | paths    | samples | shows in
HeadCosine         | point and spot | caustic     | all      | 30000   | head cosine
HeadCosine         | mirror hall    | caustic     | caustics | 2500000 | head cosine
ImageCosine        | rough metal    | caustic     | all      | 30000   | image cosine
ImageCosine        | mirror hall    | caustic     | caustics | 900000 | image cosine
ImageDistance      | rough metal    | caustic     | all      | 30000   | image distance²
ImageDistance      | mirror hall    | caustic     | caustics | 300000 | image distance²
PixelsPerSteradian | point and spot | caustic     | all      | 60000 | pixels/sr
PixelsPerSteradian | mirror hall    | caustic     | caustics | 600000 | pixels/sr
FirstCosine        | plastic        | caustic     | all      | 30000   | first cosine
FirstCosine        | mirror         | caustic     | caustics | 400000 | first cosine
Adjoint            | tank           | caustic     | caustics | 200000  | adjoint
ShadingNormals     | smooth glass   | caustic     | caustics | 450000 | shading part
ShadingNormals     | smooth mirror  | caustic     | caustics | 300000  | shading part
ShadingNormals     | bumpy mirror   | caustic     | caustics | 450000 | shading part
LargestAngle       | diffuse box    | caustic     | all      | 20000   | largest angle
WayBack            | diffuse box    | caustic     | all      | 20000   | largest angle
ConnectionCosine   | diffuse box    | lens        | all      | 20000   | connection cosine
ConnectionDistance | diffuse box    | lens        | all      | 20000   | connection distance²
ConnectionCosine   | mirror hall    | multi_chain | all      | 200000  | connection cosine
Coefficient        | open air       | lens        | all      | 30000   | Dirac coefficients
Coefficient        | tank           | lens        | all      | 60000   | Dirac coefficients
Coefficient        | textures       | caustic     | caustics | 200000  | Dirac coefficients
Selection          | open air       | lens        | all      | 30000   | selection
Selection          | tank           | caustic     | caustics | 300000  | selection
Area               | open air       | lai_lens    | all      | 40000   | aimed area
Aim                | tank           | multi_chain | all      | 100000  | turned cosine
Aim                | open air       | multi_chain | all      | 40000   | turned cosine
Choice             | mirror         | lens        | all      | 20000   | left half
Ratio              | diffuse box    | lens        | all      | 1000000 | luminance
";

/// Every fault at least once.
pub(crate) fn all_planted() -> Vec<Planted> {
    let rows = TABLE.trim().lines().skip(1);
    rows.map(|row| planted(row).unwrap_or_else(|| panic!("what is this? {row}")))
        .collect()
}

fn planted(row: &'static str) -> Option<Planted> {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let [fault, stage, mutation, paths, samples, own] = cells[..] else {
        return None;
    };
    let is_fault = |other: &Fault| format!("{other:?}") == fault;
    let is_mutation = |other: &&Mutation| other.name() == mutation;
    Some(Planted {
        fault: Fault::ALL.into_iter().find(is_fault)?,
        stage,
        mutation: *Mutation::ALL.iter().find(is_mutation)?,
        is_caustic: paths == "caustics",
        samples: samples.parse().ok()?,
        own,
    })
}

#[test]
fn every_fault_is_planted() {
    let all = all_planted();
    for fault in Fault::ALL {
        assert!(
            all.iter().any(|planted| planted.fault == fault),
            "{fault:?}"
        );
    }
}
