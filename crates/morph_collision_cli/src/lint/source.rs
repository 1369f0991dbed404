//! Where the weights of a shape come from.

use serde::Serialize;

/// The kinds of sources, in the order of the report: what an artist would act on comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    Target,
    Clip,
    Capture,
    Pair,
    Expression,
    Proof,
    Mixture,
}

impl Kind {
    /// What a number of findings is followed by.
    pub(super) fn of_findings(self) -> &'static str {
        match self {
            Self::Target => "of single targets",
            Self::Clip => "of clips",
            Self::Capture => "of captures",
            Self::Pair => "of pairs",
            Self::Expression => "of expressions",
            Self::Proof => "of the proof",
            Self::Mixture => "of mixtures",
        }
    }
}

/// Where the weights of a shape come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Target(usize),
    Pair([usize; 2]),
    Clip(String),
    Capture(String),
    Expression(String),
    Mixtures,
    /// Weights that a proof came across.
    Proof,
}

impl Source {
    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Target(_) => Kind::Target,
            Self::Pair(_) => Kind::Pair,
            Self::Clip(_) => Kind::Clip,
            Self::Capture(_) => Kind::Capture,
            Self::Expression(_) => Kind::Expression,
            Self::Mixtures => Kind::Mixture,
            Self::Proof => Kind::Proof,
        }
    }

    /// Its name, which also identifies it in a baseline.
    pub(super) fn words(&self, names: &[String]) -> String {
        let name = |target: &usize| names.get(*target).cloned().unwrap_or_else(|| target.to_string());
        match self {
            Self::Target(target) => format!("target {}", name(target)),
            Self::Pair([a, b]) => format!("pair {} + {}", name(a), name(b)),
            Self::Clip(clip) => format!("clip {clip}"),
            Self::Capture(file) => format!("capture {file}"),
            Self::Expression(name) => format!("expression {name}"),
            Self::Mixtures => "random mixtures".to_owned(),
            Self::Proof => "the proof".to_owned(),
        }
    }

    /// The targets that are tried, if they are one or two.
    pub(super) fn targets(&self) -> &[usize] {
        match self {
            Self::Target(target) => std::slice::from_ref(target),
            Self::Pair(pair) => pair,
            Self::Clip(_) | Self::Capture(_) | Self::Expression(_) | Self::Mixtures | Self::Proof => &[],
        }
    }
}
