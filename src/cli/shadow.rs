//! `--shadow`: the technique of each lamp.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use umbrage::scene::Lamp;
use umbrage::shadow::Technique;

use super::Failure;

/// How shadows are found.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ShadowArgs {
    /// How shadows are found: `auto`, or a technique, with options as in `pcf:size=512,kernel=tent5`; for one
    /// light `LAMP=TECHNIQUE`, by its name or its number from 1; may be repeated
    ///
    /// `rays`: exact ray cast. `stencil`: a stencil pass on a graphics adapter, z-pass for each shell for
    /// which it is proven right, else z-fail; `zfail`: right everywhere; `zpass`: wrong where the eye is in a
    /// shadow. `none`: light passes through everything; `dark`: the light is off. `auto`: what umbrage plan
    /// chooses within --budget, on the CPU. A name that ends in `.json` is a plan that umbrage plan -o saved,
    /// for all lights. For example: --shadow zfail --shadow 2=none.
    ///
    /// Exact shadow volumes on the CPU: `counter` (drawn in tiles, each counted from the side with less to
    /// count), `zpass-plus` (z-pass, right also where the eye is in a shadow), `zpass-reversed` (z-fail by
    /// the complement of its depth test).
    ///
    /// Hard shadows on the CPU from a shadow map: `map`, `pcf` (filtered), `map-ids` (with an exact test of
    /// the faces), `hybrid-3x3` and `hybrid-2x2` (an exact ray where nine or four texels differ),
    /// `reconstruct` (the shadow volume of the surface that the map shows).
    ///
    /// Exact hard shadows on the CPU from a light grid: `hybrid` (it proves most points lit or dark; an exact
    /// ray elsewhere), `alias-free` (points sorted into its cells, no tree over the faces).
    ///
    /// Bounded: `lod` (casters of which no lit side is seen are simplified within `move`, a fraction of their
    /// diagonal).
    ///
    /// Soft shadows of a light with an extent: `area` (the visible fraction, analytic), `samples` (exact rays
    /// to many points of it), `soft-hybrid` (the same where a shadow map is not sure), and from maps alone
    /// `pcss`, `single-sample`, `vsm`, `msm`; from silhouettes `penumbra-map` and `smoothies`; blurred in the
    /// picture `contact-blur`.
    ///
    /// On one plane, the one with most samples or `plane=A/B/C/D`: exact `planar`; soft `planar-layers`,
    /// `planar-blur` and `planar-contact`; `blob`, a spot by bounding spheres. All other surfaces take exact
    /// rays. `projective`: what the casters cover, on surfaces that do not cast, or on the plane.
    #[arg(long, visible_alias = "method", value_name = "[LAMP=]TECHNIQUE", default_value = "auto")]
    shadow: Vec<Asked>,
}

/// One `--shadow`.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Asked {
    /// Name or number; `None` for all lamps without a `--shadow` of their own.
    lamp: Option<String>,
    /// `None` for `auto`.
    technique: Option<Technique>,
    /// A saved plan instead.
    plan: Option<PathBuf>,
}

impl FromStr for Asked {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // Options of a technique come behind a colon: `key=value` is none of a lamp.
        let (lamp, technique) = match text.split_once('=') {
            Some((lamp, technique)) if !lamp.contains(':') => (Some(lamp.to_owned()), technique),
            _ => (None, text),
        };
        if technique.ends_with(".json") {
            return match lamp {
                None => Ok(Self { lamp, technique: None, plan: Some(technique.into()) }),
                Some(_) => Err(format!("a plan is for all lights; write {technique}")),
            };
        }
        let technique = match technique {
            "auto" => None,
            _ => Some(technique.parse::<Technique>().map_err(|error| error.to_string())?),
        };
        Ok(Self { lamp, technique, plan: None })
    }
}

impl ShadowArgs {
    /// The saved plan, if one is asked for, and then nothing else.
    pub(crate) fn plan(&self) -> Result<Option<&Path>, Failure> {
        match (self.shadow.iter().find_map(|asked| asked.plan.as_deref()), self.shadow.len()) {
            (Some(path), more) if more > 1 => {
                let problem = format!("--shadow {}: a plan is for all lights", path.display());
                Err(Failure::new(problem, "leave out the other --shadow"))
            }
            (plan, _) => Ok(plan),
        }
    }

    /// Whether any lamp asks for a technique that `is`.
    pub(crate) fn asks_for(&self, is: impl Fn(Option<Technique>) -> bool) -> bool {
        self.shadow.iter().any(|asked| is(asked.technique))
    }

    /// The technique of each lamp; `None` for `auto`.
    pub(crate) fn of_lamps(&self, lamps: &[Lamp]) -> Result<Vec<Option<Technique>>, Failure> {
        let mut of_all = self.shadow.iter().filter(|asked| asked.lamp.is_none());
        let general = of_all.next();
        if let Some(second) = of_all.next() {
            let name = second.technique.map_or("auto", Technique::name);
            let problem = format!("--shadow {name}: there is one for all lamps already");
            return Err(Failure::new(problem, format!("name the lamp: --shadow LAMP={name}")));
        }
        let mut techniques = vec![general.and_then(|asked| asked.technique); lamps.len()];
        for asked in &self.shadow {
            let Some(wanted) = &asked.lamp else { continue };
            let index = position(wanted, lamps)?;
            techniques[index] = asked.technique;
        }
        Ok(techniques)
    }
}

/// The lamp of this name, or else of this number, counted from 1.
fn position(wanted: &str, lamps: &[Lamp]) -> Result<usize, Failure> {
    let named = lamps.iter().position(|lamp| lamp.name == wanted && !wanted.is_empty());
    let numbered = || wanted.parse::<usize>().ok()?.checked_sub(1).filter(|&index| index < lamps.len());
    named.or_else(numbered).ok_or_else(|| {
        let problem = format!("--shadow {wanted}=: there is no such light");
        let remedy = match lamps.len() {
            1 => "leave the name out: there is one light".to_owned(),
            count => format!("use the name of a light, or a number from 1 to {count}"),
        };
        Failure::new(problem, remedy)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(texts: &[&str]) -> ShadowArgs {
        ShadowArgs { shadow: texts.iter().map(|text| text.parse().unwrap()).collect() }
    }

    #[test]
    fn shadow_of_one_lamp_wins_over_that_of_all() {
        let lamps: Vec<Lamp> =
            ["point:1,2,3", "point:2,3,4", "point:3,4,5"].map(|l| l.parse().unwrap()).into();
        let named = |name: &str, lamp: &Lamp| Lamp { name: name.to_owned(), ..lamp.clone() };
        let lamps = [named("key", &lamps[0]), named("1", &lamps[1]), lamps[2].clone()];
        let of = |texts: &[&str]| args(texts).of_lamps(&lamps).map_err(|failure| failure.to_string());
        let (rays, dark) = (Some(Technique::Rays), Some(Technique::Dark));
        assert_eq!(of(&["auto"]), Ok(vec![None; 3]));
        assert_eq!(of(&["rays"]), Ok(vec![rays; 3]));
        assert_eq!(of(&["key=dark", "rays"]), Ok(vec![dark, rays, rays]));
        assert_eq!(of(&["1=dark", "3=rays"]), Ok(vec![None, dark, rays]), "a name wins over a number");
        assert_eq!(of(&["rays", "2=auto"]), Ok(vec![rays, None, rays]));
        assert!(of(&["4=dark"]).unwrap_err().contains("a number from 1 to 3"));
        assert!(of(&["rays", "dark"]).unwrap_err().contains("--shadow LAMP=dark"));
    }

    #[test]
    fn shadow_that_is_unknown_is_refused_by_name() {
        let error = |text: &str| text.parse::<Asked>().unwrap_err();
        assert_eq!(error("2=plan.json"), "a plan is for all lights; write plan.json");
        assert!(error("key=ray").starts_with("`ray` is not a technique"));
        assert!(error("zfail:size=3").contains("no option `size`"));
    }
}
