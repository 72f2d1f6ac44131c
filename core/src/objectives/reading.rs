//! Two readings of the paper's objectives, and the parameters it leaves open.

use super::diversity::{Rule, Spread};

/// Which reading of the four objectives is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Form {
    /// What we plan with.
    ///
    /// C, Q and D weigh faces by area, because triangle counts are an artefact of modelling. Q and T
    /// are divided by the object's total, because the mean of Q spans a factor of 27 between
    /// objects and the paper's "+ 1" drowns it. D is `3 cbrt(var_x var_y var_z)`, because the plain
    /// product is at most 1/27 and its smoothed value is constant to three digits; a face seen from
    /// behind counts as one seen from the front. T looks at the object's pixels only, because over
    /// the whole picture it follows the silhouette's area.
    #[default]
    Default,
    /// The paper's equations as they stand: faces by count, eq. `obj_Q_2` with its "+ 1", the
    /// product of variances, signed incidence, T over the whole picture as the views' mean.
    Literal,
}

/// A reading with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// Default or literal.
    pub form: Form,
    /// d_Q in [0, 1): each further sight of a face adds this share of the last one's Q.
    pub geometry_discount: f32,
    /// d_T in [0, 1): likewise for T.
    pub texture_discount: f32,
    /// sigma_Q > 0 of the Laplacian of Gaussian, in mean edge lengths; the literal form divides by it.
    pub sigma_q: f32,
    /// beta_Q > 0, the literal form's factor.
    pub beta_q: f32,
}

impl Default for Reading {
    fn default() -> Self {
        Self {
            form: Form::Default,
            geometry_discount: 0.5,
            texture_discount: 0.25,
            sigma_q: 1.0,
            beta_q: 1.0,
        }
    }
}

impl Reading {
    /// The paper's equations as they stand, with the discounts of the default.
    pub fn literal() -> Self {
        Self { form: Form::Literal, ..Self::default() }
    }

    /// Whether every parameter is in its range: gains of C, Q and T then never rise.
    pub(crate) fn is_sound(&self) -> bool {
        let discounts = [self.geometry_discount, self.texture_discount];
        let factors = [self.sigma_q, self.beta_q];
        discounts.iter().all(|discount| (0.0..1.0).contains(discount))
            && factors.iter().all(|factor| *factor > 0.0 && factor.is_finite())
    }

    pub(crate) fn diversity_rule(&self) -> Rule {
        match self.form {
            Form::Default => Rule { spread: Spread::CubeRoot, two_sided: true },
            Form::Literal => Rule { spread: Spread::Product, two_sided: false },
        }
    }
}
