for (const button of document.querySelectorAll(".flip")) {
  button.addEventListener("click", () => button.classList.toggle("turned"));
}
