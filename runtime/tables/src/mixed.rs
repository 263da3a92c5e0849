//! A linear mixed model with a random intercept for each participant, fitted by restricted maximum likelihood (REML).
//!
//! The model is y = X β + Z b + ε with b ~ N(0, `σ_b²` I), one b for each participant, and ε ~ N(0, σ² I). With the ratio
//! θ = `σ_b²` / σ², the covariance of y is σ² V(θ), V(θ) = I + θ Z Zᵀ. For given θ the best β and σ² have a closed form, so
//! minus twice the restricted log-likelihood is a function of θ alone (Harville 1977; Bates et al. 2015, section 3.4):
//!
//! −2 ℓ(θ) = (n − p) (1 + ln(2π `σ̂²`)) + ln |V| + ln |Xᵀ V⁻¹ X|, with `σ̂²` = yᵀ P y / (n − p)
//!
//! where P = V⁻¹ − V⁻¹ X (Xᵀ V⁻¹ X)⁻¹ Xᵀ V⁻¹. `profile` evaluates it with its first two derivatives, `search` finds its
//! minimum over θ ≥ 0, and `inference` gives standard errors, degrees of freedom and tests.
//!
//! Degrees of freedom are Satterthwaite's (Giesbrecht and Burns 1985), from the observed information as in lmerTest
//! (Kuznetsova, Brockhoff and Christensen 2017). At the boundary θ = 0 they are n − p, and all else is ordinary least
//! squares; so it is where no participant has two observations, as then θ has no estimate.
//!
//! # References
//! - Bates, Mächler, Bolker and Walker (2015). Fitting linear mixed-effects models using lme4. J. Stat. Softw. 67(1).
//! - Giesbrecht and Burns (1985). Two-stage analysis based on a mixed model. Biometrics 41, 477–486.
//! - Harville (1977). Maximum likelihood approaches to variance component estimation. JASA 72, 320–338.
//! - Kuznetsova, Brockhoff and Christensen (2017). lmerTest package. J. Stat. Softw. 82(13).

mod inference;
mod profile;
mod search;

use faer::{
    Mat, Side,
    prelude::{Solve as _, SolveLstsq as _},
};

pub use inference::{Contrast, WaldTest};
use profile::{Point, Profile};

/// A fitted model.
#[derive(Clone, Debug)]
pub struct MixedModel {
    /// Observations, n.
    pub observations: usize,
    /// Participants.
    pub participants: usize,
    /// Estimates of the fixed effects β, one for each column of X.
    pub estimates: Vec<f64>,
    /// Standard deviation of the participants' intercepts, `σ_b`, in the outcome's unit.
    pub participant_sd: f64,
    /// Standard deviation of the residuals, σ, in the outcome's unit.
    pub residual_sd: f64,
    /// The restricted log-likelihood at its maximum, ℓ. Models of different X cannot be compared by it.
    pub log_likelihood: f64,
    /// How the ratio of variances was found.
    pub ratio: Ratio,
    /// The factor R of X = Q R.
    triangle: Mat<f64>,
    /// The profile at the estimate of θ, in the basis Q.
    point: Point,
    /// Minus the derivative of Qᵀ V⁻¹ Q by θ there.
    between: Mat<f64>,
    /// Covariance of the estimates of θ and of σ² (in units of `scale`²); `None` where θ is not free.
    variance_covariance: Option<[[f64; 2]; 2]>,
    /// σ² in units of `scale`².
    variance: f64,
    /// Degrees of freedom where θ is not free, or its curvature is not positive.
    plain_freedom: f64,
    /// The norm of the residuals of ordinary least squares, which scales the profile.
    scale: f64,
}

/// How the ratio of variances θ was found.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Ratio {
    /// The derivative is zero there.
    Interior,
    /// The likelihood is greatest at θ = 0.
    Boundary,
    /// The search ended before the derivative was zero to rounding.
    NotConverged,
    /// No participant was observed twice: θ is 0 by definition.
    NotRepeated,
}

/// Why a mixed model has no fit. Texts say what to do.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum MixedError {
    /// Columns, outcomes and participants are not of one length.
    #[error("the design has {rows} rows, but there are {outcomes} outcomes of {participants} participants")]
    Shape {
        /// Rows of the shortest column.
        rows: usize,
        /// Outcomes.
        outcomes: usize,
        /// Participants' places.
        participants: usize,
    },
    /// There is no residual degree of freedom.
    #[error("{observations} sessions are too few for {terms} terms: add sessions, or leave conditions out")]
    TooFew {
        /// Observations.
        observations: usize,
        /// Columns.
        terms: usize,
    },
    /// A value is not a finite number.
    #[error("a value of the outcome or of a condition is not a finite number: correct it, or leave its session out")]
    NotFinite,
    /// All values are equal.
    #[error("the outcome is the same in all sessions: there is no variance to explain")]
    Constant,
    /// The columns are linearly dependent.
    #[error("the conditions are collinear: leave one of them out")]
    Collinear,
    /// There is one participant.
    #[error("all sessions are of one participant: a random intercept needs two participants or more")]
    OneParticipant,
    /// The conditions leave no degree of freedom between participants.
    #[error(
        "{participants} participants are too few for {terms} terms that vary between participants: add participants, or leave a condition out"
    )]
    TooFewParticipants {
        /// Participants.
        participants: usize,
        /// Terms that vary between them, the intercept included.
        terms: usize,
    },
    /// The conditions leave no degree of freedom within participants.
    #[error(
        "the conditions account for every difference within participants: add sessions per participant, or leave a condition out"
    )]
    NoneWithin,
    /// Nothing is left to estimate σ² from.
    #[error("sessions of one participant do not differ beside the conditions: there is no residual variance")]
    NoResidual,
}

/// What is left of the outcome beyond this share of it is no more than rounding.
const ROUNDING: f64 = 1e-12;

/// An eigenvalue of a projection above this counts as one dimension.
const DIMENSION: f64 = 1e-9;

impl MixedModel {
    /// Fits the model to `outcomes`, one for each row of the columns of X, of the participants with these numbers
    /// (equal numbers mean the same participant; their values do not matter). X must have the intercept among its columns
    /// or in their span.
    ///
    /// # Errors
    /// [`MixedError`].
    pub fn fit(columns: &[Vec<f64>], outcomes: &[f64], participants: &[usize]) -> Result<Self, MixedError> {
        let (rows, terms) = check(columns, outcomes, participants)?;
        let design = Mat::from_fn(rows, terms, |row, column| columns[column][row]);
        let outcome = Mat::from_fn(rows, 1, |row, _| outcomes[row]);
        let qr = design.qr();
        let triangle = qr.thin_R().to_owned();
        let largest = (0..terms).map(|place| triangle[(place, place)].abs()).fold(0.0, f64::max);
        if (0..terms).any(|place| triangle[(place, place)].abs() <= ROUNDING * largest) {
            return Err(MixedError::Collinear);
        }
        let ordinary = qr.solve_lstsq(&outcome);
        let residuals = &outcome - &design * &ordinary;
        let scale = residuals.norm_l2();
        if scale <= ROUNDING * outcome.norm_l2() {
            return Err(MixedError::NoResidual);
        }
        let profile = Profile::new(&qr.compute_thin_Q(), &residuals, scale, participants);
        let (point, ratio) = estimate(&profile)?;
        Ok(Self::at(&profile, point, ratio, triangle, &ordinary, scale))
    }

    fn at(profile: &Profile, point: Point, ratio: Ratio, triangle: Mat<f64>, ordinary: &Mat<f64>, scale: f64) -> Self {
        let freedom = profile.residual_freedom();
        let variance = point.residual / freedom;
        let shift = triangular_solve(&triangle, &point.solution);
        let estimates = (0..shift.len()).map(|place| ordinary[(place, 0)] + scale * shift[place]).collect();
        let is_free = matches!(ratio, Ratio::Interior | Ratio::NotConverged);
        let variance_covariance = is_free.then(|| profile.variance_covariance(&point)).flatten();
        let plain_freedom = if is_free { profile.between_freedom() as f64 } else { freedom };
        let residual_sd = scale * variance.sqrt();
        let log_det_triangle: f64 = (0..shift.len()).map(|place| 2.0 * triangle[(place, place)].abs().ln()).sum();
        let deviance = freedom * (1.0 + (std::f64::consts::TAU * residual_sd * residual_sd).ln())
            + point.log_determinants
            + log_det_triangle;
        Self {
            observations: profile.rows(),
            participants: profile.participants(),
            estimates,
            participant_sd: residual_sd * point.ratio.sqrt(),
            residual_sd,
            log_likelihood: -0.5 * deviance,
            ratio,
            triangle,
            between: profile.between(&point),
            point,
            variance_covariance,
            variance,
            plain_freedom,
            scale,
        }
    }

    /// The intraclass correlation: the share of the variance that is between participants, `σ_b²` / (`σ_b²` + σ²).
    #[must_use]
    pub fn intraclass_correlation(&self) -> f64 {
        self.point.ratio / (1.0 + self.point.ratio)
    }
}

/// Checks shapes and values; gives the numbers of rows and columns.
fn check(columns: &[Vec<f64>], outcomes: &[f64], participants: &[usize]) -> Result<(usize, usize), MixedError> {
    let (rows, terms) = (outcomes.len(), columns.len());
    if columns.iter().any(|column| column.len() != rows) || participants.len() != rows {
        let shortest = columns.iter().map(Vec::len).min().unwrap_or(0);
        return Err(MixedError::Shape { rows: shortest, outcomes: rows, participants: participants.len() });
    }
    if rows <= terms || terms == 0 {
        return Err(MixedError::TooFew { observations: rows, terms });
    }
    if columns.iter().flatten().chain(outcomes).any(|value| !value.is_finite()) {
        return Err(MixedError::NotFinite);
    }
    if outcomes.iter().all(|value| *value == outcomes[0]) {
        return Err(MixedError::Constant);
    }
    Ok((rows, terms))
}

/// The estimate of θ, where the design allows one.
fn estimate(profile: &Profile) -> Result<(Point, Ratio), MixedError> {
    if profile.participants() == profile.rows() {
        let point = profile.at(0.0).ok_or(MixedError::Collinear)?;
        return Ok((point, Ratio::NotRepeated));
    }
    if profile.participants() < 2 {
        return Err(MixedError::OneParticipant);
    }
    if profile.between_freedom() == 0 {
        let (participants, terms) = (profile.participants(), profile.between_terms());
        return Err(MixedError::TooFewParticipants { participants, terms });
    }
    if profile.within_freedom() == 0 {
        return Err(MixedError::NoneWithin);
    }
    search::minimise(profile)
}

/// Solves R x = b for the upper triangle R.
fn triangular_solve(triangle: &Mat<f64>, right: &[f64]) -> Vec<f64> {
    let mut solution = right.to_vec();
    for row in (0..right.len()).rev() {
        let known: f64 = (row + 1..right.len()).map(|column| triangle[(row, column)] * solution[column]).sum();
        solution[row] = (solution[row] - known) / triangle[(row, row)];
    }
    solution
}

/// Solves Rᵀ x = b for the upper triangle R.
fn transposed_solve(triangle: &Mat<f64>, right: &[f64]) -> Vec<f64> {
    let mut solution = right.to_vec();
    for row in 0..right.len() {
        let known: f64 = (0..row).map(|column| triangle[(column, row)] * solution[column]).sum();
        solution[row] = (solution[row] - known) / triangle[(row, row)];
    }
    solution
}

/// The inverse of a symmetric positive definite matrix, and the logarithm of its determinant; `None` if it is not.
fn inverse(matrix: faer::MatRef<'_, f64>) -> Option<(Mat<f64>, f64)> {
    let factor = matrix.llt(Side::Lower).ok()?;
    let log_determinant = (0..matrix.nrows()).map(|place| 2.0 * factor.L()[(place, place)].ln()).sum();
    Some((factor.solve(Mat::<f64>::identity(matrix.nrows(), matrix.nrows())), log_determinant))
}
