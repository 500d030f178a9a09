// Counts before anything else can fail; the page's test reads it.
{
  const page = document.documentElement.dataset;
  const count = (type, name, note = () => {}) => {
    page[name] = "0";
    addEventListener(type, event => {
      page[name] = String(Number(page[name]) + 1);
      note(event);
    });
  };
  count("error", "scriptErrors");
  count("securitypolicyviolation", "policyViolations", event => {
    page.policyLastStopped = `${event.effectiveDirective} ${event.blockedURI}`;
  });
}
