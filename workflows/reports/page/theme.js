"use strict";
document.documentElement.classList.add("js");
{
  const button = document.getElementById("theme-toggle");
  const prefersDark = matchMedia("(prefers-color-scheme: dark)");

  // A page opened from a file may have no storage; the choice then lasts as long as the page.
  const storage = (use) => {
    try {
      return use(localStorage);
    } catch {
      return null;
    }
  };

  const theme = () => document.documentElement.dataset.theme ?? (prefersDark.matches ? "dark" : "light");
  const label = () => {
    const other = theme() === "dark" ? "light" : "dark";
    button.textContent = other === "dark" ? "Dark" : "Light";
    button.setAttribute("aria-label", `switch to ${other} colours`);
  };

  const kept = storage((store) => store.getItem("moseg-theme"));
  if (kept === "light" || kept === "dark") document.documentElement.dataset.theme = kept;
  label();
  prefersDark.addEventListener("change", label);
  button.addEventListener("click", () => {
    const other = theme() === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = other;
    storage((store) => store.setItem("moseg-theme", other));
    label();
  });
}
