"""Light studies behind `lta light`: link budget, bearings, strategies and lamp layout."""
