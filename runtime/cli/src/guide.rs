//! `cohabit guide`: the guide, which is a part of the program, on a page of this machine or in the terminal.

mod book;
mod markdown;
mod pages;
#[cfg(test)]
mod tests;

use std::{
    env, fmt,
    net::{Ipv4Addr, SocketAddr},
    process::{Command, Stdio},
    sync::atomic::Ordering,
    thread,
};

use anyhow::Context as _;
use clap::ValueEnum;
use cohabit_dialog::{Framing, ServerLimits, Site, site_of_files, token};

use crate::{failure::bad_input, site::listen, stop, terminal::print};

/// Shows the guide: serves it to browsers of this machine, without a network, or prints one page of it to the terminal
#[derive(clap::Args)]
pub struct Guide {
    /// The port of the guide; 0 takes any that is free
    #[arg(long, default_value_t = 8780)]
    port: u16,
    /// Whether the guide is opened in the browser, too, where there is a desktop
    #[arg(long, value_name = "YES|NO", default_value_t)]
    open: Opened,
    /// Print this page to the terminal instead, such as `study`
    #[arg(long, value_name = "PAGE", conflicts_with_all = ["port", "open"])]
    text: Option<String>,
}

/// Whether the guide is opened.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, ValueEnum)]
enum Opened {
    /// In the browser of the desktop.
    #[default]
    Yes,
    /// Its address is printed, and no more.
    No,
}

impl fmt::Display for Opened {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Yes => "yes",
            Self::No => "no",
        })
    }
}

impl Guide {
    /// Serves the guide until the user ends it, or prints a page.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.text {
            Some(name) => print_page(name),
            None => self.serve(),
        }
    }

    fn serve(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let asked = SocketAddr::from((Ipv4Addr::LOCALHOST, self.port));
        let (listener, listening) = listen("the guide", asked)?;
        let address = token::site_address(listening, false);
        println!("Open {address}/  (Ctrl-C ends it)");
        if self.open == Opened::Yes {
            open(address);
        }
        let site = Site {
            router: site_of_files(pages::files(), pages::missing()),
            hosts: Vec::new(),
            identity: None,
            limits: ServerLimits::default(),
            framing: Framing::default(),
        };
        site.serve(listener, &|| stop.load(Ordering::Relaxed)).context("serve the guide")
    }
}

fn print_page(name: &str) -> anyhow::Result<()> {
    let page = book::page(name).ok_or_else(|| {
        let known: Vec<&str> = book::PAGES.iter().map(|page| page.name).collect();
        bad_input(format!("the guide has no page `{name}`: choose one of {}", known.join(", ")))
    })?;
    print(page.text)
}

/// Opens an address in the browser, where there is a desktop. Where that fails, the address has been printed.
fn open(address: String) {
    let has_desktop = ["DISPLAY", "WAYLAND_DISPLAY"].into_iter().any(|name| env::var_os(name).is_some());
    if has_desktop {
        thread::spawn(move || {
            let mut browser = Command::new("xdg-open");
            browser.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status()
        });
    }
}
