"""The page of `moseg view`: HTML, CSS and ES modules, as the browser gets them."""
