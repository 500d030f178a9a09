// Counts before anything else can fail; the page's test reads it.
{
  const page = document.documentElement.dataset;
  const count = (event, name) => {
    page[name] = "0";
    addEventListener(event, () => { page[name] = String(Number(page[name]) + 1); });
  };
  count("error", "scriptErrors");
  count("securitypolicyviolation", "policyViolations");
}
