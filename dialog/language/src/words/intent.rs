//! What a clause asks for.

use cohabit_cdf::catalog::Property;
use serde::{Deserialize, Serialize};

/// The kinds of requests, by the verbs that carry them.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Intent {
    Stop,
    GoTo,
    Find,
    Travel,
    Turn,
    Look,
    LookAround,
    PickUp,
    Bring,
    Place,
    Drop,
    Open,
    Close,
    Break,
    Cut,
    Scan,
    Pour,
    Toggle,
    TurnOn,
    TurnOff,
    Fill,
    Clean,
    Examine,
    /// To look at what is in or on something, which is opened for it.
    LookIn,
    /// To look at what lies under it or behind it.
    LookUnder,
    Throw,
    Discard,
    Highlight,
    Heat,
    Cool,
    Repair,
    Color,
    Print,
    Toast,
    Carrot,
    Resize,
    Shrink,
    Brew,
    Dry,
    Iron,
    Fold,
    Unfold,
    Water,
    /// To pour boiling water into a cup.
    Tea,
    Swap,
    Use,
    Impossible,
    /// Nothing is asked for, but something is spoken of.
    Mention,
}

impl Intent {
    /// What the object of this request should afford, any of them.
    pub(crate) const fn affordances(self) -> &'static [Property] {
        match self {
            Self::PickUp
            | Self::Bring
            | Self::Place
            | Self::Drop
            | Self::Heat
            | Self::Cool
            | Self::Repair
            | Self::Swap => &[Property::Pickupable],
            Self::Print | Self::Toast | Self::Carrot | Self::Resize | Self::Shrink | Self::Color | Self::Clean => {
                &[Property::Pickupable]
            }
            Self::Open | Self::Close => &[Property::Openable],
            Self::Dry | Self::Iron | Self::Fold | Self::Unfold => &[Property::Dirtyable],
            Self::Break => &[Property::Breakable],
            Self::Cut => &[Property::Cuttable],
            Self::Toggle | Self::TurnOn | Self::TurnOff => &[Property::Toggleable],
            Self::Fill | Self::Pour | Self::Brew | Self::Tea => &[Property::Fillable],
            _ => &[],
        }
    }

    /// Whether it means nothing without an object.
    pub(crate) const fn needs_object(self) -> bool {
        matches!(
            self,
            Self::PickUp
                | Self::Bring
                | Self::Open
                | Self::Close
                | Self::Break
                | Self::Cut
                | Self::Scan
                | Self::Toggle
                | Self::TurnOn
                | Self::TurnOff
                | Self::Fill
                | Self::Clean
                | Self::Examine
                | Self::LookIn
                | Self::LookUnder
                | Self::Find
                | Self::Highlight
                | Self::Heat
                | Self::Cool
                | Self::Repair
                | Self::Dry
                | Self::Iron
                | Self::Fold
                | Self::Unfold
                | Self::Water
        )
    }

    /// Whether it is carried out with the object in the hand, so that what is held is meant first.
    pub(crate) const fn is_about_held(self) -> bool {
        matches!(
            self,
            Self::Place
                | Self::Drop
                | Self::Bring
                | Self::Pour
                | Self::Fill
                | Self::Clean
                | Self::Throw
                | Self::Discard
                | Self::Heat
                | Self::Cool
                | Self::Repair
                | Self::Color
                | Self::Toast
                | Self::Carrot
                | Self::Resize
                | Self::Shrink
                | Self::Brew
                | Self::Dry
        )
    }

    /// Whether it changes or destroys what it is done to.
    pub(crate) const fn changes(self) -> bool {
        matches!(
            self,
            Self::Break
                | Self::Cut
                | Self::Throw
                | Self::Discard
                | Self::Pour
                | Self::Fill
                | Self::Clean
                | Self::Heat
                | Self::Cool
                | Self::Repair
                | Self::Color
                | Self::Print
                | Self::Toast
                | Self::Carrot
                | Self::Resize
                | Self::Shrink
                | Self::Brew
                | Self::Dry
                | Self::Iron
                | Self::Fold
                | Self::Unfold
                | Self::Water
        )
    }

    /// What is done by hand with an action that is called otherwise by itself: to fold is to close.
    pub(crate) const BY_HAND: [Self; 4] = [Self::Iron, Self::Fold, Self::Unfold, Self::Water];

    /// How such a deed is called while it is done.
    pub(crate) const fn doing(self) -> &'static str {
        match self {
            Self::Iron => "ironing",
            Self::Fold => "folding",
            Self::Unfold => "unfolding",
            Self::Water => "watering",
            _ => "doing",
        }
    }

    /// The plain form of the verb, for questions and refusals.
    pub(crate) const fn verb(self) -> &'static str {
        match self {
            Self::Stop => "stop",
            Self::GoTo | Self::Travel => "go to",
            Self::Find => "find",
            Self::Turn => "turn",
            Self::Look => "look",
            Self::LookAround => "look around",
            Self::PickUp => "pick up",
            Self::Bring => "bring",
            Self::Place => "put",
            Self::Drop => "put down",
            Self::Open => "open",
            Self::Close => "close",
            Self::Break => "break",
            Self::Cut => "cut",
            Self::Scan => "scan",
            Self::Pour => "pour",
            Self::Toggle => "switch",
            Self::TurnOn => "turn on",
            Self::TurnOff => "turn off",
            Self::Fill => "fill",
            Self::Clean => "clean",
            Self::Examine => "look at",
            Self::LookIn => "look in",
            Self::LookUnder => "look under",
            Self::Throw => "throw",
            Self::Discard => "throw away",
            Self::Highlight => "show",
            Self::Heat => "heat",
            Self::Cool => "cool",
            Self::Repair => "repair",
            Self::Color => "color",
            Self::Print => "print",
            Self::Toast => "toast",
            Self::Carrot => "turn into a carrot",
            Self::Resize => "make bigger",
            Self::Shrink => "make smaller",
            Self::Brew => "make coffee in",
            Self::Dry => "dry",
            Self::Iron => "iron",
            Self::Fold => "fold",
            Self::Unfold => "unfold",
            Self::Water => "water",
            Self::Tea => "make tea in",
            Self::Swap => "swap",
            Self::Use => "use",
            Self::Impossible => "do that to",
            Self::Mention => "mention",
        }
    }
}
