"""Who may walk how far, and who has somewhere to go and gets on."""
